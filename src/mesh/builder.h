#pragma once
#include <utility>
#include <vector>

#include "palpate/mesh/mesh.h"
#include "palpate/mesh/quality.h"

namespace palpate::mesh {

/// Collects the points and elements of a generated mesh.
struct Builder {
  std::vector<Vec3> points;
  std::vector<Eigen::Vector4i> tets;
  std::vector<Eigen::Vector3i> faces;

  /// Appends one point; returns its index.
  int add_point(const Vec3& p) {
    points.push_back(p);
    return static_cast<int>(points.size()) - 1;
  }
  const Vec3& point(int i) const { return points[static_cast<std::size_t>(i)]; }

  /// Adds a tetrahedron; its nodes are reordered if necessary to make the volume positive.
  void add_tet(int a, int b, int c, int d) {
    if (tet_volume(point(a), point(b), point(c), point(d)) < 0) std::swap(c, d);
    tets.emplace_back(a, b, c, d);
  }

  /// Returns the points and the tetrahedra.
  TetMesh tet_mesh() const {
    TetMesh out{gathered(points), Tets(4, static_cast<Eigen::Index>(tets.size()))};
    for (std::size_t t = 0; t < tets.size(); ++t) out.tets.col(static_cast<Eigen::Index>(t)) = tets[t];
    return out;
  }

  /// Returns the faces, and the points that they use in their order.
  TriMesh tri_mesh() const {
    std::vector<int> new_index(points.size(), -1);
    for (const auto& face : faces)
      for (const int v : face) new_index[static_cast<std::size_t>(v)] = 0;
    std::vector<Vec3> used;
    for (std::size_t v = 0; v < points.size(); ++v)
      if (new_index[v] == 0) {
        new_index[v] = static_cast<int>(used.size());
        used.push_back(points[v]);
      }
    TriMesh out{gathered(used), Faces(3, static_cast<Eigen::Index>(faces.size()))};
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (int k = 0; k < 3; ++k)
        out.faces(k, static_cast<Eigen::Index>(f)) = new_index[static_cast<std::size_t>(faces[f][k])];
    return out;
  }

 private:
  /// Converts a list of points to columns.
  static Points gathered(const std::vector<Vec3>& from) {
    Points out(3, static_cast<Eigen::Index>(from.size()));
    for (std::size_t i = 0; i < from.size(); ++i) out.col(static_cast<Eigen::Index>(i)) = from[i];
    return out;
  }
};

}  // namespace palpate::mesh
