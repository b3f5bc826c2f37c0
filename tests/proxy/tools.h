#pragma once
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include "palpate/mesh/mesh.h"

/// Rigid tools with concave shapes.
namespace tools {

using namespace palpate;

/// A torus around the z axis with `around` by `across` quadrilaterals and its vertices on the exact surface.
inline TriMesh torus(double radius, double tube, int around, int across) {
  TriMesh out;
  out.vertices.resize(3, around * across);
  out.faces.resize(3, 2 * around * across);
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2 * M_PI * i / around, v = 2 * M_PI * j / across, r = radius + tube * std::cos(v);
      out.vertices.col(i * across + j) = Vec3(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
      const auto at = [&](int k, int l) { return (i + k) % around * across + (j + l) % across; };
      out.faces.col(2 * (i * across + j)) = Eigen::Vector3i(at(0, 0), at(1, 0), at(1, 1));
      out.faces.col(2 * (i * across + j) + 1) = Eigen::Vector3i(at(0, 0), at(1, 1), at(0, 1));
    }
  return out;
}

/// Surface of the cubes of edge `edge` for which `solid` holds, with cell (i, j, k) starting at edge (i, j,
/// k); no two of them may meet at an edge or a corner only.
inline TriMesh of_cubes(const std::array<int, 3>& cells, double edge,
                        const std::function<bool(int, int, int)>& solid) {
  std::map<std::array<int, 3>, int> vertex;
  std::vector<Vec3> points;
  std::vector<Eigen::Vector3i> faces;
  const auto requested = [&](std::array<int, 3> c) {
    for (int axis = 0; axis < 3; ++axis)
      if (c[static_cast<std::size_t>(axis)] < 0 ||
          c[static_cast<std::size_t>(axis)] >= cells[static_cast<std::size_t>(axis)])
        return false;
    return solid(c[0], c[1], c[2]);
  };
  const auto at = [&](const std::array<int, 3>& corner) {
    const auto [found, is_new] = vertex.try_emplace(corner, static_cast<int>(points.size()));
    if (is_new) points.push_back(edge * Vec3(corner[0], corner[1], corner[2]));
    return found->second;
  };
  for (int i = 0; i < cells[0]; ++i)
    for (int j = 0; j < cells[1]; ++j)
      for (int k = 0; k < cells[2]; ++k)
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const int side : {0, 1}) {
            const std::array<int, 3> cell{i, j, k};
            std::array<int, 3> next = cell;
            next[axis] += side ? 1 : -1;
            if (!requested(cell) || requested(next)) continue;
            std::array<int, 4> corner{};
            for (std::size_t c = 0; c < 4; ++c) {  // counter-clockwise about +axis
              std::array<int, 3> place = cell;
              place[axis] += side;
              place[(axis + 1) % 3] += c == 1 || c == 2;
              place[(axis + 2) % 3] += c >= 2;
              corner[c] = at(place);
            }
            if (side == 0) std::swap(corner[1], corner[3]);
            faces.emplace_back(corner[0], corner[1], corner[2]);
            faces.emplace_back(corner[0], corner[2], corner[3]);
          }
  TriMesh out;
  out.vertices.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) out.vertices.col(static_cast<Eigen::Index>(i)) = points[i];
  out.faces.resize(3, static_cast<Eigen::Index>(faces.size()));
  for (std::size_t i = 0; i < faces.size(); ++i) out.faces.col(static_cast<Eigen::Index>(i)) = faces[i];
  return out;
}

/// Two prongs down from a bridge, x in [-1.5, 1.5], y in [-0.5, 0.5], z in [0, 3]; prongs 1 wide, the bridge
/// above z = 2. `fine` cubes per unit length.
inline TriMesh fork(int fine) {
  TriMesh out = of_cubes({3 * fine, fine, 3 * fine}, 1.0 / fine,
                         [fine](int i, int, int k) { return k >= 2 * fine || i < fine || i >= 2 * fine; });
  out.vertices.row(0).array() -= 1.5;
  out.vertices.row(1).array() -= 0.5;
  return out;
}

}  // namespace tools
