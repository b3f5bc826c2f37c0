#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>
#include <vector>

#include "palpate/mesh/mesh.h"

/// Properties of surfaces that the tests check.
namespace palpate {

inline Vec3 vertex(const TriMesh& m, Eigen::Index face, int k) { return m.vertices.col(m.faces(k, face)); }

/// Smallest angle of all triangles [degrees].
inline double smallest_angle_deg(const TriMesh& m) {
  double smallest = 180.0;
  for (Eigen::Index f = 0; f < m.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = vertex(m, f, (k + 1) % 3) - vertex(m, f, k),
                 v = vertex(m, f, (k + 2) % 3) - vertex(m, f, k);
      smallest = std::min(smallest, std::atan2(u.cross(v).norm(), u.dot(v)) * 180.0 / std::numbers::pi);
    }
  return smallest;
}

/// V - E + F of a closed surface, with E = 3 F / 2: 2 for a sphere, 0 with one hole through it.
inline int euler_characteristic(const TriMesh& m) {
  return static_cast<int>(m.vertices.cols() - m.faces.cols() / 2);
}

inline int pieces(const TriMesh& m) {
  std::vector<int> parent(static_cast<std::size_t>(m.vertices.cols()));
  for (std::size_t v = 0; v < parent.size(); ++v) parent[v] = static_cast<int>(v);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (Eigen::Index f = 0; f < m.faces.cols(); ++f)
    for (int k = 1; k < 3; ++k) parent[root(m.faces(k, f))] = root(m.faces(0, f));
  int n = 0;
  for (int v = 0; v < static_cast<int>(parent.size()); ++v) n += root(v) == v ? 1 : 0;
  return n;
}

/// Returns whether the segment pq crosses the triangle abc at an inner point of both (five signs of volumes).
/// An end within 1e-9 of the triangle's size of its plane does not count: on a gear's flat faces, signs there
/// are rounding.
inline bool crosses(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double before = normal.dot(p - a), after = normal.dot(q - a),
               rounding = 1e-9 * normal.norm() * (b - a).norm();
  if (before * after > 0.0 || std::min(std::abs(before), std::abs(after)) < rounding) return false;
  const Vec3 d = q - p;
  const double u = d.dot((a - p).cross(b - p)), v = d.dot((b - p).cross(c - p)),
               w = d.dot((c - p).cross(a - p));
  return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

/// Number of pairs of triangles without a common vertex that intersect. All pairs whose boxes share a cell of
/// a grid are tested.
/// @param looked_at  number of pairs tested
inline int self_intersections(const TriMesh& m, long* looked_at) {
  double edge = 0.0;
  for (Eigen::Index f = 0; f < m.faces.cols(); ++f)
    edge += (vertex(m, f, 0) - vertex(m, f, 1)).norm() / static_cast<double>(m.faces.cols());
  const double cell = 1.5 * edge;
  const auto key = [](int i, int j, int k) {
    return (static_cast<std::uint64_t>(i + (1 << 20)) << 42) |
           (static_cast<std::uint64_t>(j + (1 << 20)) << 21) | static_cast<std::uint64_t>(k + (1 << 20));
  };
  std::unordered_map<std::uint64_t, std::vector<int>> grid;
  struct Box {
    Eigen::Vector3i low, high;
  };
  std::vector<Box> boxes;
  for (int f = 0; f < m.faces.cols(); ++f) {
    const Vec3 a = vertex(m, f, 0), b = vertex(m, f, 1), c = vertex(m, f, 2);
    const Vec3 low = a.cwiseMin(b).cwiseMin(c) / cell, high = a.cwiseMax(b).cwiseMax(c) / cell;
    boxes.push_back({low.array().floor().cast<int>(), high.array().floor().cast<int>()});
    for (int i = boxes.back().low.x(); i <= boxes.back().high.x(); ++i)
      for (int j = boxes.back().low.y(); j <= boxes.back().high.y(); ++j)
        for (int k = boxes.back().low.z(); k <= boxes.back().high.z(); ++k) grid[key(i, j, k)].push_back(f);
  }
  int found = 0;
  *looked_at = 0;
  for (const auto& [place, faces] : grid)
    for (std::size_t x = 0; x < faces.size(); ++x)
      for (std::size_t y = x + 1; y < faces.size(); ++y) {
        const int f = faces[x], g = faces[y];
        // the pair is counted in the first cell that both touch
        const Eigen::Vector3i first = boxes[f].low.cwiseMax(boxes[g].low);
        if (key(first.x(), first.y(), first.z()) != place) continue;
        bool touch = false;
        for (int k = 0; k < 3; ++k)
          for (int l = 0; l < 3; ++l) touch = touch || m.faces(k, f) == m.faces(l, g);
        if (touch) continue;
        ++*looked_at;
        bool cut = false;
        for (int k = 0; k < 3 && !cut; ++k)
          cut = crosses(vertex(m, f, k), vertex(m, f, (k + 1) % 3), vertex(m, g, 0), vertex(m, g, 1),
                        vertex(m, g, 2)) ||
                crosses(vertex(m, g, k), vertex(m, g, (k + 1) % 3), vertex(m, f, 0), vertex(m, f, 1),
                        vertex(m, f, 2));
        found += cut ? 1 : 0;
      }
  return found;
}

/// Returns whether each vertex has its bitwise mirror image about x = 0 among the vertices.
inline bool is_its_mirror_image(const TriMesh& m) {
  std::vector<std::array<double, 3>> points, images;
  for (Eigen::Index v = 0; v < m.vertices.cols(); ++v) {
    points.push_back({m.vertices(0, v), m.vertices(1, v), m.vertices(2, v)});
    images.push_back({0.0 - m.vertices(0, v), m.vertices(1, v), m.vertices(2, v)});
  }
  std::sort(points.begin(), points.end());
  std::sort(images.begin(), images.end());
  return points == images;
}

}  // namespace palpate
