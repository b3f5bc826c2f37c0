#include "mesh/polygon.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/surface_checks.h"
#include "palpate/core/error.h"

// The plane is the least-squares plane of the corners, because the vector area of a crossed outline may
// vanish.  Its normal points to the side of Newell's, the sum of the cross products of neighbouring corners.
// The projection drops the coordinate along which the normal is largest.  It leaves the other two bitwise
// unchanged, so that collinear corners stay collinear.
//
// An edge that the outline traverses in both directions bounds nothing: it is the bridge to a hole.  All
// other edges are constraints.  A triangle is inside if a path to infinity crosses an odd number of them.  A
// polygon of n corners has n - 2 triangles; another number means that the outline touches itself.
namespace palpate::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;  // index of the corner
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel,  // 1: inside, 0: outside, -1: unvisited
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>, CGAL::No_constraint_intersection_tag>;
using Triangles = std::vector<std::array<int, 3>>;

/// Returns the unit normal of the plane through the corners; zero if they lie on a line.
Vec3 normal_of(const std::vector<Vec3>& corners) {
  Vec3 middle = Vec3::Zero(), newell = Vec3::Zero();
  for (const Vec3& p : corners) middle += p / static_cast<double>(corners.size());
  Mat3 spread = Mat3::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = corners[i] - middle, b = corners[(i + 1) % corners.size()] - middle;
    spread += a * a.transpose();
    newell += a.cross(b);
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(spread);  // ascending
  constexpr double kRounding = 1e-14;                      // on squares: a width below 1e-7 of the length
  if (!(axes.eigenvalues()[1] > kRounding * axes.eigenvalues()[2])) return Vec3::Zero();
  const Vec3 normal = axes.eigenvectors().col(0);
  return newell.dot(normal) < 0.0 ? Vec3(-normal) : normal;
}

double largest_extent(const std::vector<Vec3>& corners) {
  Vec3 low = corners[0], high = corners[0];
  for (const Vec3& p : corners) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return (high - low).norm();
}

double warp_of(const std::vector<Vec3>& corners, const Vec3& normal, double extent) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : corners) middle += p / static_cast<double>(corners.size());
  double out = 0;
  for (const Vec3& p : corners) out = std::max(out, std::abs(normal.dot(p - middle)));
  return out / extent;
}

Triangles fan(std::size_t corners) {
  Triangles out;
  for (int i = 1; i + 1 < static_cast<int>(corners); ++i) out.push_back({0, i, i + 1});
  return out;
}

/// Whether every triangle is oriented like the polygon, and none is degenerate: then the fan covers a simple
/// polygon once.
bool turns_along(const std::vector<Vec3>& corners, const Triangles& triangles, const Vec3& normal) {
  return std::all_of(triangles.begin(), triangles.end(), [&](const std::array<int, 3>& t) {
    const auto at = [&](std::size_t k) -> const Vec3& { return corners[static_cast<std::size_t>(t[k])]; };
    const Vec3 a = at(1) - at(0), b = at(2) - at(0);
    const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
    return normal.dot(a.cross(b)) > kDegenerateTriangle * longest;
  });
}

/// Returns the angle that a fan sweeps about its corner: below a full turn unless the outline winds about it
/// twice.
double swept(const std::vector<Vec3>& corners) {
  double out = 0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec3 a = corners[i] - corners[0], b = corners[i + 1] - corners[0];
    out += std::atan2(a.cross(b).norm(), a.dot(b));
  }
  return out;
}

void mark_inside(Triangulation& all) {
  for (const auto face : all.all_face_handles()) face->info() = -1;
  std::vector<Triangulation::Face_handle> open{all.infinite_face()};
  all.infinite_face()->info() = 0;
  while (!open.empty()) {
    const auto face = open.back();
    open.pop_back();
    for (int i = 0; i < 3; ++i) {
      const auto next = face->neighbor(i);
      if (next->info() >= 0) continue;
      next->info() = face->info() ^ static_cast<int>(face->is_constrained(i));
      open.push_back(next);
    }
  }
}

/// Returns the triangles of the projection; empty if the outline crosses or touches itself.
Triangles delaunay(const std::vector<Vec3>& corners, const Vec3& normal) {
  Eigen::Index dropped = 0;
  normal.cwiseAbs().maxCoeff(&dropped);
  Eigen::Index u = (dropped + 1) % 3, v = (dropped + 2) % 3;
  if (normal[dropped] < 0) std::swap(u, v);
  Triangulation all;
  std::vector<Triangulation::Vertex_handle> vertex;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto before = all.number_of_vertices();
    vertex.push_back(all.insert({corners[i][u], corners[i][v]}));
    if (all.number_of_vertices() > before) vertex.back()->info() = static_cast<int>(i);
  }
  std::map<std::array<int, 2>, int> passed;  // number of passes per edge (its corners)
  for (std::size_t i = 0; i < vertex.size(); ++i) {
    const int a = vertex[i]->info(), b = vertex[(i + 1) % vertex.size()]->info();
    if (a != b) ++passed[{std::min(a, b), std::max(a, b)}];
  }
  try {
    for (const auto& [edge, times] : passed)
      if (times % 2 == 1)
        all.insert_constraint(vertex[static_cast<std::size_t>(edge[0])],
                              vertex[static_cast<std::size_t>(edge[1])]);
  } catch (const Triangulation::Intersection_of_constraints_exception&) { return {}; }
  mark_inside(all);
  Triangles out;
  for (const auto face : all.finite_face_handles())
    if (face->info() == 1)
      out.push_back({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
  std::sort(out.begin(), out.end());
  return out.size() + 2 == corners.size() ? out : Triangles{};
}

}  // namespace

PolygonCut cut_polygon(const std::vector<Vec3>& corners) {
  constexpr double kWholeTurn = 6.283185307179586;
  PolygonCut out{fan(corners.size())};
  const double extent = largest_extent(corners);
  if (corners.size() < 4) return out;
  const Vec3 normal = normal_of(corners);
  if (normal.isZero(0.0)) return out;
  out.warp = warp_of(corners, normal, extent);
  if (turns_along(corners, out.triangles, normal) && swept(corners) < kWholeTurn) return out;
  Triangles cut = delaunay(corners, normal);
  out.simple = !cut.empty();
  if (out.simple) out.triangles = std::move(cut);
  return out;
}

void append_polygon(const std::vector<Vec3>& points, const std::vector<int>& polygon,
                    std::vector<std::array<int, 3>>& triangles, PolygonReport& report) {
  std::vector<int> distinct = polygon;
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  while (distinct.size() > 1 && distinct.front() == distinct.back()) distinct.pop_back();
  // With fewer than three corners the face is kept unchanged, so that later face checks report it.
  const std::vector<int>& named = distinct.size() < 3 ? polygon : distinct;
  std::vector<Vec3> corners;
  for (const int i : named) corners.push_back(points[static_cast<std::size_t>(i)]);
  const PolygonCut cut = cut_polygon(corners);
  const auto element = static_cast<int>(triangles.size());
  if (!cut.simple && ++report.crossing == 1) report.first_crossing = element;
  if (cut.warp > kPlanar) {
    ++report.warped;
    if (cut.warp > report.largest_warp) report.most_warped = element;
  }
  report.largest_warp = std::max(report.largest_warp, cut.warp);
  for (const auto& [a, b, c] : cut.triangles)
    triangles.push_back({named[static_cast<std::size_t>(a)], named[static_cast<std::size_t>(b)],
                         named[static_cast<std::size_t>(c)]});
}

std::string warped_text(const PolygonReport& report, const Provenance& from) {
  if (report.warped == 0) return {};
  return fmt::format(
      "{}: this polygon deviates from a plane by {:.2g} % of its extent{}; it is split along diagonals "
      "between its corners",
      from.element(report.most_warped), 100 * report.largest_warp,
      report.warped == 1 ? "" : fmt::format(" (the largest of {})", report.warped));
}

std::string crossing_text(const PolygonReport& report, const Provenance& from) {
  if (report.crossing == 0) return {};
  return fmt::format(
      "{}: the outline of this polygon crosses or touches itself{}; cut it into triangles in a mesh editor",
      from.element(report.first_crossing),
      report.crossing == 1 ? "" : fmt::format(" (the first of {})", report.crossing));
}

}  // namespace palpate::mesh
