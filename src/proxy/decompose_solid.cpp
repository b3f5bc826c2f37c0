// The solid B is cut by planes into B in C_1, B in C_2, ..., the cells C boxes that tile a box around it. The
// content of one cell, P = closure(int B in int C), is in the hull of its extreme points (Krein and Milman
// 1940), and there are few of these.  Where such a point e is inside B, P equals C in a neighbourhood of e,
// so e is a corner of C.  Where e is on the surface and a face through it continues into the cell, e is in
// the part of the face that lies in the cell.  Where no face does, a neighbourhood of e in the cell is solid,
// and e is again a corner of C.  So
//
//   P is in the hull of { corners of the faces' parts in C } and { corners of C that are in B or on it }.
//
// Whether a corner is solid towards the cell is tested one small step into the cell: a surface that is closer
// to the corner than the step makes an error no larger than the step.  A proxy's hull is spanned by these
// points and the whole faces that it owns, reduced to the few points that lie farthest out.
// ProxyHull::outside is the distance of the other points outside the hull; ProxySet computes it for the
// members.
//
// Cutting criterion.  A ray from a point of the surface along its normal exits the hull at once where the
// solid is convex, and late where a hollow is in front: the gap of HullQuality, whose integral over the
// surface is about the hollow's volume.  The piece with the largest hollow is cut across one of the three
// axes, in its middle or, where the two parts then have clearly less hollow volume, at the point of the
// largest gap.
#include "proxy/decompose_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "proxy/convex_hull.h"
#include "proxy/hull.h"
#include "proxy/hull_quality.h"
#include "proxy/solid_piece.h"
#include "proxy/table.h"

namespace palpate::proxy {
namespace {

constexpr double kFlat = 1e-9;     // tolerance of a point in a plane [solid sizes]
constexpr double kStep = 1e-7;     // step into a cell [solid sizes]
constexpr int kGapSamples = 1000;  // polygons of a piece that decide whether to cut it
constexpr int kCutSamples = 600;   // polygons of a piece that decide where to cut it
constexpr int kDirections = 64;    // directions whose farthest points represent a piece's hull

Points columns(const std::vector<Vec3>& points) {
  Points out(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) out.col(static_cast<Eigen::Index>(i)) = points[i];
  return out;
}

/// Returns the points that lie farthest in `count` directions of a Fibonacci spiral, after scaling the points
/// to equal extent along the axes.
std::vector<int> farthest_points(const Points& points, int count) {
  const Vec3 extent = points.rowwise().maxCoeff() - points.rowwise().minCoeff();
  const Vec3 scale = extent.cwiseMax(1e-6 * extent.maxCoeff()).cwiseInverse();
  Table columns;
  columns.append(points);
  std::vector<int> out;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, azimuth = i * M_PI * (3.0 - std::sqrt(5.0)),
                 r = std::sqrt(1.0 - z * z);
    const Vec3 direction = Vec3(r * std::cos(azimuth), r * std::sin(azimuth), z).cwiseProduct(scale);
    const int at = farthest(columns.read(0), columns.size(), direction.data());
    out.push_back(at < points.cols() ? at : 0);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

struct Solid {
  TriMesh surface;  // in its principal axes
  std::vector<int> all_faces;
  Box box;
  double size = 0.0;

  bool holds(const Vec3& point) const {
    return std::abs(mesh::winding_number(surface, all_faces, point)) > 0.5;
  }
};

/// Hollow between a piece and its hull.
struct Hollow {
  double volume = 0.0;  // integral of the gap [m^3]
  double gap = 0.0;     // largest gap [m]
  Vec3 deepest = Vec3::Zero();
};
struct Measured {
  SolidPiece piece;
  Hollow hollow;
};

/// Returns every n-th polygon of a piece, so that at most `most` remain.
SolidPiece thinned(const SolidPiece& piece, std::size_t most) {
  const std::size_t step = 1 + piece.surface.size() / most;
  SolidPiece out;
  out.cell = piece.cell;
  for (std::size_t i = 0; i < piece.surface.size(); i += step) out.surface.push_back(piece.surface[i]);
  return out;
}

ConvexHull hull_of(const SolidPiece& piece) {
  std::vector<Vec3> points;
  for (const Polygon& polygon : piece.surface)
    points.insert(points.end(), polygon.corner.begin(), polygon.corner.begin() + polygon.count);
  const Points all = columns(points);
  return convex_hull(all(Eigen::all, farthest_points(all, kDirections)));
}

Hollow hollow_of(const SolidPiece& piece) {
  Hollow out;
  const ConvexHull hull = hull_of(piece);
  for (const Polygon& polygon : piece.surface) {
    const Vec3 area = polygon.area();
    if (area.isZero()) continue;
    const double gap = gap_along(hull, polygon.middle(), area.normalized());
    out.volume += area.norm() * gap;
    if (gap <= out.gap) continue;
    out.gap = gap;
    out.deepest = polygon.middle();
  }
  return out;
}

Measured measured(SolidPiece piece) {
  const SolidPiece some = thinned(piece, kGapSamples);
  Hollow hollow = hollow_of(some);
  hollow.volume *= static_cast<double>(piece.surface.size()) / static_cast<double>(some.surface.size());
  return {std::move(piece), hollow};
}

/// Returns the two halves of the best cut; empty if no cut has surface on both sides.
std::vector<SolidPiece> best_cut(const Measured& from, const Solid& solid) {
  constexpr double kMargin = 0.02, kClearlyLess = 0.9;
  const SolidPiece some = thinned(from.piece, kCutSamples);
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Polygon& polygon : some.surface)
    for (int k = 0; k < polygon.count; ++k) {
      low = low.cwiseMin(polygon.corner[static_cast<std::size_t>(k)]);
      high = high.cwiseMax(polygon.corner[static_cast<std::size_t>(k)]);
    }
  int longest = 0, best_axis = -1;
  (high - low).maxCoeff(&longest);
  double best_at = 0.0, least = std::numeric_limits<double>::infinity();
  for (const bool at_deepest : {false, true})
    for (int k = 0; k < 3; ++k) {
      const int axis = (longest + k) % 3;
      const double at = at_deepest ? from.hollow.deepest[axis] : 0.5 * (low[axis] + high[axis]),
                   margin = kMargin * (high[axis] - low[axis]);
      if (at < low[axis] + margin || at > high[axis] - margin) continue;
      const auto halves = cut(some, solid.surface, axis, at, kFlat * solid.size);
      if (halves[0].surface.empty() || halves[1].surface.empty()) continue;
      const double left = hollow_of(halves[0]).volume + hollow_of(halves[1]).volume;
      if (!(left < kClearlyLess * least)) continue;
      least = left;
      best_axis = axis;
      best_at = at;
    }
  if (best_axis < 0) return {};
  auto halves = cut(from.piece, solid.surface, best_axis, best_at, kFlat * solid.size);
  return {std::make_move_iterator(halves.begin()), std::make_move_iterator(halves.end())};
}

std::vector<SolidPiece> cut_up(const Solid& solid, const SolidOptions& options) {
  std::vector<Measured> pieces;
  pieces.push_back(measured(whole_piece(solid.surface)));
  while (static_cast<int>(pieces.size()) < options.count) {
    const auto hollow = [&](const Measured& one) {
      return one.hollow.gap > options.tolerance * solid.size ? one.hollow.volume : 0.0;
    };
    const auto worst =
        std::max_element(pieces.begin(), pieces.end(),
                         [&](const Measured& a, const Measured& b) { return hollow(a) < hollow(b); });
    if (hollow(*worst) == 0.0) break;
    auto halves = best_cut(*worst, solid);
    if (halves.empty()) {
      worst->hollow.volume = 0.0;
      continue;
    }
    *worst = measured(std::move(halves[0]));
    pieces.push_back(measured(std::move(halves[1])));
  }
  std::vector<SolidPiece> out;
  for (Measured& one : pieces) out.push_back(std::move(one.piece));
  return out;
}

ProxyHull proxy_of(const SolidPiece& piece, const Solid& solid, const SolidOptions& options) {
  ProxyHull out;
  for (const int f : piece.faces)
    for (const int v : solid.surface.faces.col(f)) out.members.push_back(v);
  std::sort(out.members.begin(), out.members.end());
  out.members.erase(std::unique(out.members.begin(), out.members.end()), out.members.end());
  std::vector<Vec3> inner;  // points that are not members
  for (const Polygon& polygon : piece.surface)
    if (polygon.is_cut || !std::binary_search(piece.faces.begin(), piece.faces.end(), polygon.face))
      for (int k = 0; k < polygon.count; ++k) inner.push_back(polygon.corner[static_cast<std::size_t>(k)]);
  const Vec3 middle = 0.5 * (piece.cell.low + piece.cell.high);
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner(i & 1 ? piece.cell.low.x() : piece.cell.high.x(),
                      i & 2 ? piece.cell.low.y() : piece.cell.high.y(),
                      i & 4 ? piece.cell.low.z() : piece.cell.high.z());
    // The solid ends at its box, so such a corner lies on the surface.
    if (solid.box.high.cwiseEqual(corner).any() || solid.box.low.cwiseEqual(corner).any()) continue;
    if (solid.holds(corner + kStep * solid.size * (middle - corner).normalized())) inner.push_back(corner);
  }
  const auto members = static_cast<Eigen::Index>(out.members.size());
  Points points(3, members + static_cast<Eigen::Index>(inner.size()));
  points.leftCols(members) = solid.surface.vertices(Eigen::all, out.members);
  points.rightCols(static_cast<Eigen::Index>(inner.size())) = columns(inner);
  const Points farthest = points(Eigen::all, farthest_points(points, 2 * kDirections));
  out.corners = farthest(Eigen::all, greedy_corners(farthest, options.max_corners, 1e-4 * solid.size));
  const ConvexHull hull = convex_hull(out.corners);
  const Hull whole(out.corners);
  for (const Vec3& x : inner)
    if (hull.beyond(x) > 0.0)
      out.outside = std::max(out.outside, nearest_difference(Hull(Points(x)), whole).norm());
  out.outside += kStep * solid.size;
  return out;
}

void check(const TriMesh& surface, const SolidOptions& options) {
  if (surface.faces.cols() == 0) fail("convex decomposition: the surface has no faces");
  if (options.count < 1) fail("convex decomposition: count = {} must be at least 1", options.count);
  if (options.max_corners < 4)
    fail("convex decomposition: max_corners = {} must be at least 4", options.max_corners);
  if (!(options.tolerance >= 0.0))
    fail("convex decomposition: tolerance = {} must not be negative", options.tolerance);
}

}  // namespace

std::vector<ProxyHull> decompose_solid(const TriMesh& surface, const SolidOptions& options,
                                       DecomposeReport* report) {
  check(surface, options);
  const Mat3 axes = principal_axes(surface);
  Solid solid;
  solid.surface = {axes.transpose() * surface.vertices, surface.faces};
  solid.box = {solid.surface.vertices.rowwise().minCoeff(), solid.surface.vertices.rowwise().maxCoeff()};
  solid.size = (solid.box.high - solid.box.low).norm();
  solid.all_faces.resize(static_cast<std::size_t>(surface.faces.cols()));
  std::iota(solid.all_faces.begin(), solid.all_faces.end(), 0);
  std::vector<ProxyHull> proxies;
  for (const SolidPiece& piece : cut_up(solid, options)) {
    proxies.push_back(proxy_of(piece, solid, options));
    proxies.back().corners = axes * proxies.back().corners;
  }
  if (report) *report = decompose_report(surface, proxies);
  return proxies;
}

ProxySet rigid_proxies(const TriMesh& surface, const SolidOptions& options) {
  constexpr int kPatchFaces = 16;  // few faces in total: finer patches cost more than they save
  LayeredModel model;
  model.name = "rigid surface";
  model.skin = surface;
  model.proxies = decompose_solid(surface, options);
  return ProxySet(model, {.patch_faces = kPatchFaces});
}

}  // namespace palpate::proxy
