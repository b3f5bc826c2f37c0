#pragma once
#include <array>
#include <vector>

#include "palpate/mesh/mesh.h"

namespace contact_tests {

using namespace palpate;

/// A closed prism along y over a polygon in (x, z), counter-clockwise seen from -y.
inline TriMesh prism(const std::vector<Eigen::Vector2d>& polygon,
                     const std::vector<std::array<int, 3>>& triangles, double half_width) {
  const auto n = static_cast<int>(polygon.size());
  TriMesh mesh;
  mesh.vertices.resize(3, 2 * n);
  for (int i = 0; i < n; ++i)
    for (int side = 0; side < 2; ++side)
      mesh.vertices.col(i + side * n) =
          Vec3(polygon[static_cast<std::size_t>(i)].x(), side ? half_width : -half_width,
               polygon[static_cast<std::size_t>(i)].y());
  std::vector<Eigen::Vector3i> faces;
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    faces.emplace_back(i, j + n, j);
    faces.emplace_back(i, i + n, j + n);
  }
  for (const auto& t : triangles) {
    faces.emplace_back(t[0], t[1], t[2]);
    faces.emplace_back(t[0] + n, t[2] + n, t[1] + n);
  }
  mesh.faces.resize(3, static_cast<Eigen::Index>(faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.faces.col(static_cast<Eigen::Index>(f)) = faces[f];
  return mesh;
}

}  // namespace contact_tests
