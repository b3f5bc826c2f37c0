#include "palpate/model/quality_gate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "palpate/core/error.h"
#include "palpate/mesh/quality.h"

namespace palpate::model {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// Longest edge over 2 sqrt(6) times the inscribed radius 3 V / (sum of the faces' areas); the regular
/// tetrahedron has the radius edge / (2 sqrt 6).
double aspect(const TetMesh& mesh, int tet) {
  double area = 0, longest = 0;
  for (const auto& face : mesh::kTetFaces) {
    const auto corner = [&](int k) -> Vec3 { return mesh.nodes.col(mesh.tets(face[k], tet)); };
    area += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 2;
  }
  for (const auto& [i, j] : mesh::kTetEdges)
    longest =
        std::max(longest, (mesh.nodes.col(mesh.tets(i, tet)) - mesh.nodes.col(mesh.tets(j, tet))).norm());
  return longest * area / (6 * std::sqrt(6.0) * mesh::tet_volume(mesh, tet));
}

Vec3 middle(const TetMesh& mesh, int tet) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 4; ++k) sum += mesh.nodes.col(mesh.tets(k, tet));
  return sum / 4;
}

}  // namespace

TetQuality measure_quality(const TetMesh& mesh, double surface_volume) {
  TetQuality out;
  out.nodes = static_cast<int>(mesh.nodes.cols());
  out.tetrahedra = static_cast<int>(mesh.tets.cols());
  double edges = 0;
  for (int t = 0; t < out.tetrahedra; ++t) {
    const auto angles = mesh::dihedral_angles(mesh, t);
    const auto [least, largest] = std::minmax_element(angles.begin(), angles.end());
    if (*least * kDegrees < out.smallest_dihedral_deg) {
      out.smallest_dihedral_deg = *least * kDegrees;
      out.worst_tet = t;
    }
    out.largest_dihedral_deg = std::max(out.largest_dihedral_deg, *largest * kDegrees);
    out.worst_aspect = std::max(out.worst_aspect, aspect(mesh, t));
    out.volume += mesh::tet_volume(mesh, t);
    for (const auto& [i, j] : mesh::kTetEdges)
      edges += (mesh.nodes.col(mesh.tets(i, t)) - mesh.nodes.col(mesh.tets(j, t))).norm();
  }
  out.mean_edge = edges / (6.0 * std::max(out.tetrahedra, 1));
  out.surface_volume = surface_volume;
  out.volume_error = std::abs(out.volume / surface_volume - 1);
  return out;
}

void pass_gate(const TetMesh& mesh, const TetQuality& quality, const QualityGate& gate,
               const std::string& source) {
  if (quality.tetrahedra == 0)
    fail(
        "{}: no tetrahedron was made; the surface is too thin for this element size, ask for more with "
        "--tetrahedra",
        source);
  if (!(quality.smallest_dihedral_deg >= gate.smallest_dihedral_deg)) {
    const Vec3 at = middle(mesh, quality.worst_tet);
    fail(
        "{}: tetrahedron {} at ({:.4g}, {:.4g}, {:.4g}) m has a dihedral angle of {:.2f} degrees, must have "
        "{:g}: the mesh is refused; ask for another number with "
        "--tetrahedra, or smooth the surface there",
        source, quality.worst_tet, at.x(), at.y(), at.z(), quality.smallest_dihedral_deg,
        gate.smallest_dihedral_deg);
  }
  if (!(quality.volume_error <= gate.volume_error))
    fail(
        "{}: the tetrahedra fill {:.6g} m^3 of the surface's {:.6g} m^3, {:.2f} % off, must lie within {:g} "
        "%: the mesh is refused; ask for more with --tetrahedra",
        source, quality.volume, quality.surface_volume, 100 * quality.volume_error, 100 * gate.volume_error);
}

}  // namespace palpate::model
