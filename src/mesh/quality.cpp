#include "palpate/mesh/quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace palpate::mesh {

double tet_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a) / 6.0;
}

double tet_volume(const TetMesh& mesh, int tet) {
  const auto n = mesh.tets.col(tet);
  return tet_volume(mesh.nodes.col(n[0]), mesh.nodes.col(n[1]), mesh.nodes.col(n[2]), mesh.nodes.col(n[3]));
}

// Faces f and g meet in the edge that joins the two nodes other than f and g.  With outward normals n_f, n_g
// the inner angle is pi minus the angle between them: atan2(|n_f x n_g|, -n_f . n_g), accurate for slivers
// too.
std::array<double, 6> dihedral_angles(const TetMesh& mesh, int tet) {
  std::array<Vec3, 4> normal;
  for (std::size_t f = 0; f < 4; ++f) {
    const auto corner = [&](int k) -> Vec3 { return mesh.nodes.col(mesh.tets(kTetFaces[f][k], tet)); };
    normal[f] = (corner(1) - corner(0)).cross(corner(2) - corner(0));
  }
  std::array<double, 6> out;
  for (std::size_t e = 0; e < 6; ++e) {
    const auto& opposite = kTetEdges[5 - e];  // the edges are listed so that e and 5 - e share no node
    const Vec3 &n = normal[static_cast<std::size_t>(opposite[0])],
               &m = normal[static_cast<std::size_t>(opposite[1])];
    out[e] = std::atan2(n.cross(m).norm(), -n.dot(m));
  }
  return out;
}

MeshReport measure(const TetMesh& mesh) {
  MeshReport out;
  out.nodes = static_cast<int>(mesh.nodes.cols());
  out.elements = static_cast<int>(mesh.tets.cols());
  out.smallest_edge = std::numeric_limits<double>::infinity();
  double smallest_angle = std::numbers::pi;
  for (int t = 0; t < out.elements; ++t) {
    out.volume += tet_volume(mesh, t);
    const auto angles = dihedral_angles(mesh, t);
    smallest_angle = std::min(smallest_angle, *std::min_element(angles.begin(), angles.end()));
    for (const auto& [i, j] : kTetEdges) {
      const double edge = (mesh.nodes.col(mesh.tets(i, t)) - mesh.nodes.col(mesh.tets(j, t))).norm();
      out.largest_edge = std::max(out.largest_edge, edge);
      out.smallest_edge = std::min(out.smallest_edge, edge);
    }
  }
  out.smallest_dihedral_deg = smallest_angle * 180.0 / std::numbers::pi;
  return out;
}

}  // namespace palpate::mesh
