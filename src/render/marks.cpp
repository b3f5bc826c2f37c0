#include "render/marks.h"

#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::render {
namespace {

/// Surface under construction, as points and triangles.
struct Pieces {
  std::vector<Vec3> points;
  std::vector<Eigen::Vector3i> faces;

  Surface surface() const {
    Surface out;
    out.points.resize(3, static_cast<Eigen::Index>(points.size()));
    out.faces.resize(3, static_cast<Eigen::Index>(faces.size()));
    for (std::size_t i = 0; i < points.size(); ++i) out.points.col(static_cast<Eigen::Index>(i)) = points[i];
    for (std::size_t i = 0; i < faces.size(); ++i) out.faces.col(static_cast<Eigen::Index>(i)) = faces[i];
    return out;
  }
};

/// Adds a bar of square section between two points, open at its ends.
void add_bar(Pieces& pieces, const Vec3& from, const Vec3& to, double width) {
  const Vec3 along = to - from;
  if (!(along.norm() > 0.0)) return;
  const Vec3 u = along.unitOrthogonal() * (width / 2), v = along.normalized().cross(u);
  const int first = static_cast<int>(pieces.points.size());
  for (const Vec3& end : {from, to})
    for (const Vec3& corner : {Vec3(u), Vec3(v), Vec3(-u), Vec3(-v)}) pieces.points.push_back(end + corner);
  for (int k = 0; k < 4; ++k) {
    const int a = first + k, b = first + (k + 1) % 4;
    pieces.faces.emplace_back(a, b, a + 4);
    pieces.faces.emplace_back(b, b + 4, a + 4);
  }
}

}  // namespace

Surface outline(const Points& points, const Faces& faces, double width, double least_deg) {
  PALPATE_CHECK(width > 0.0, "outline: width = {}", width);
  const auto normal = [&](int f) {
    const Vec3 a = points.col(faces(0, f));
    return Vec3((points.col(faces(1, f)) - a).cross(points.col(faces(2, f)) - a).normalized());
  };
  std::map<std::pair<int, int>, std::vector<int>> faces_of_edge;
  for (int f = 0; f < faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int i = faces(k, f), j = faces((k + 1) % 3, f);
      faces_of_edge[{std::min(i, j), std::max(i, j)}].push_back(f);
    }
  const double flat = std::cos(least_deg * std::numbers::pi / 180.0);
  Pieces pieces;
  for (const auto& [edge, around] : faces_of_edge)
    if (around.size() != 2 || normal(around[0]).dot(normal(around[1])) < flat)
      add_bar(pieces, points.col(edge.first), points.col(edge.second), width);
  return pieces.surface();
}

Surface rings(const Vec3& semi_axes, double width) {
  PALPATE_CHECK(width > 0.0 && semi_axes.minCoeff() >= 0.0, "rings: width {}, semi-axes {} {} {}", width,
                semi_axes.x(), semi_axes.y(), semi_axes.z());
  constexpr int kPieces = 64;
  Pieces pieces;
  for (int normal = 0; normal < 3; ++normal) {
    const int a = (normal + 1) % 3, b = (normal + 2) % 3;
    const auto at = [&](int i) {
      const double angle = 2.0 * std::numbers::pi * i / kPieces;
      return Vec3(semi_axes[a] * std::cos(angle) * Vec3::Unit(a) +
                  semi_axes[b] * std::sin(angle) * Vec3::Unit(b));
    };
    for (int i = 0; i < kPieces; ++i) add_bar(pieces, at(i), at(i + 1), width);
  }
  return pieces.surface();
}

Surface bar(const Vec3& from, const Vec3& to, double width) {
  PALPATE_CHECK(width > 0.0, "bar: width = {}", width);
  Pieces pieces;
  add_bar(pieces, from, to, width);
  return pieces.surface();
}

Surface dots(const Points& points, double size) {
  PALPATE_CHECK(size > 0.0, "dots: size = {}", size);
  Pieces pieces;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const int first = static_cast<int>(pieces.points.size());
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {1.0, -1.0})
        pieces.points.push_back(points.col(i) + sign * size / 2 * Vec3::Unit(axis));
    // Tips +x -x +y -y +z -z: one outward face per octant.
    for (int octant = 0; octant < 8; ++octant) {
      const int x = first + (octant & 1), y = first + 2 + (octant >> 1 & 1),
                z = first + 4 + (octant >> 2 & 1);
      const bool odd = ((octant & 1) + (octant >> 1 & 1) + (octant >> 2 & 1)) % 2 == 1;
      pieces.faces.emplace_back(odd ? Eigen::Vector3i(x, z, y) : Eigen::Vector3i(x, y, z));
    }
  }
  return pieces.surface();
}

}  // namespace palpate::render
