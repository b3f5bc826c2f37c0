#include "distance/points.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "palpate/core/error.h"

namespace palpate::distance {
namespace {

/// Numbering of the triangles' corners: one per vertex of the skin, one per division point of an edge and
/// number of segments, one per point inside a face.
class Corners {
 public:
  Corners(const Skin& skin, std::vector<ContactPoint>& out)
      : skin_(skin), out_(out), at_vertex_(static_cast<std::size_t>(skin.vertex_count()), -1) {}

  /// Returns the index of a corner, and adds the point where it is new.
  /// @param i, j  distances from the edges opposite to the face's corners 0 and 1, in units of 1/n
  int number(int face, int n, int i, int j) {
    const std::array<int, 3> parts = {i, j, n - i - j};
    const auto zeros = std::count(parts.begin(), parts.end(), 0);
    if (zeros == 2) {
      const int corner = i ? 0 : j ? 1 : 2;
      int& known = at_vertex_[static_cast<std::size_t>(skin_.faces(corner, face))];
      return known < 0 ? known = add(face, n, parts) : known;
    }
    if (zeros == 0) {
      if (face != within_) inside_.fill(-1);
      within_ = face;
      int& known = inside_[static_cast<std::size_t>(kMostCuts * i + j)];
      return known < 0 ? known = add(face, n, parts) : known;
    }
    const int opposite = i == 0 ? 0 : j == 0 ? 1 : 2;
    int from = (opposite + 1) % 3, to = (opposite + 2) % 3;
    if (skin_.faces(from, face) > skin_.faces(to, face)) std::swap(from, to);
    const std::array<int, 4> key = {skin_.faces(from, face), skin_.faces(to, face), n,
                                    parts[static_cast<std::size_t>(to)]};
    const auto [known, is_new] = on_edge_.try_emplace(key, -1);
    if (is_new) known->second = add(face, n, parts);
    return known->second;
  }

 private:
  int add(int face, int n, const std::array<int, 3>& parts) {
    out_.push_back({face, Vec3(parts[0], parts[1], parts[2]) / n, 0.0});
    return static_cast<int>(out_.size()) - 1;
  }

  const Skin& skin_;
  std::vector<ContactPoint>& out_;
  std::vector<int> at_vertex_;
  int within_ = -1;                                  ///< Face of the points in inside_.
  std::array<int, kMostCuts * kMostCuts> inside_{};  ///< Points inside that face, by i and j.
  std::map<std::array<int, 4>, int>
      on_edge_;  ///< Key: lower vertex, higher vertex, number of segments, segments from the lower vertex.
};

void collect_fans(ContactMesh& mesh) {
  mesh.fan_begin.assign(mesh.points.size() + 1, 0);
  for (const ContactTriangle& t : mesh.triangles)
    for (const int p : t.points) ++mesh.fan_begin[static_cast<std::size_t>(p) + 1];
  std::partial_sum(mesh.fan_begin.begin(), mesh.fan_begin.end(), mesh.fan_begin.begin());
  std::vector<int> next(mesh.fan_begin.begin(), mesh.fan_begin.end() - 1);
  mesh.fan.resize(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const int p : mesh.triangles[t].points)
      mesh.fan[static_cast<std::size_t>(next[static_cast<std::size_t>(p)]++)] = static_cast<int>(t);
}

}  // namespace

int cuts_of(const Skin& skin, int face, double spacing) {
  // An edge as long as the spacing, up to rounding, is not divided.
  constexpr double kRounding = 1e-9;
  return static_cast<int>(
      std::clamp(std::ceil(skin.longest_edge[face] / spacing - kRounding), 1.0, double{kMostCuts}));
}

ContactMesh contact_mesh(const Skin& skin, double spacing) {
  if (!(spacing > 0.0)) fail("contact points: spacing = {} m must be positive", spacing);
  ContactMesh out;
  Corners corners(skin, out.points);
  for (int face = 0; face < skin.face_count(); ++face) {
    if (skin.area[face] == 0.0) continue;  // Padding duplicate.
    const int n = cuts_of(skin, face, spacing);
    const auto add = [&](const std::array<std::array<int, 2>, 3>& at) {
      ContactTriangle triangle{.area = skin.area[face] / (n * n)};
      for (std::size_t k = 0; k < 3; ++k) {
        triangle.points[k] = corners.number(face, n, at[k][0], at[k][1]);
        out.points[static_cast<std::size_t>(triangle.points[k])].area += triangle.area / 3.0;
      }
      out.triangles.push_back(triangle);
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        add({{{i + 1, j}, {i, j + 1}, {i, j}}});
        if (i + j + 1 < n) add({{{i, j + 1}, {i + 1, j}, {i + 1, j + 1}}});
      }
  }
  collect_fans(out);
  return out;
}

// Up to third-order terms the height of the surface over a triangle is quadratic, and its mean equals the
// mean of its values at the edge midpoints. The area of flat triangles falls short of the surface's by c e^2.
// Subdivision into four triangles at the edge midpoints, lifted onto the surface, reduces the error to a
// quarter, hence A = (4 A_4 - A_1)/3 (Richardson extrapolation).
void fit_to_surface(ContactMesh& mesh, const Points& at, const std::function<Vec3(const Vec3&)>& onto) {
  const auto area = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return 0.5 * (b - a).cross(c - a).norm();
  };
  for (ContactPoint& point : mesh.points) point.area = 0.0;
  for (ContactTriangle& t : mesh.triangles) {
    const Mat3 x = at(Eigen::all, t.points);
    Mat3 lifted;
    t.lowered = 0.0;
    for (int k = 0; k < 3; ++k) {
      const Vec3 middle = 0.5 * (x.col((k + 1) % 3) + x.col((k + 2) % 3));
      lifted.col(k) = onto(middle);
      t.lowered += (lifted.col(k) - middle).norm() / 3.0;
    }
    double four = area(lifted.col(0), lifted.col(1), lifted.col(2));
    for (int k = 0; k < 3; ++k) four += area(x.col(k), lifted.col((k + 1) % 3), lifted.col((k + 2) % 3));
    t.area = (4.0 * four - area(x.col(0), x.col(1), x.col(2))) / 3.0;
    for (const int p : t.points) mesh.points[static_cast<std::size_t>(p)].area += t.area / 3.0;
  }
}

}  // namespace palpate::distance
