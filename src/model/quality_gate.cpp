#include "model/quality_gate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "palpate/core/error.h"
#include "palpate/mesh/quality.h"

namespace palpate::model {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// Returns the longest edge over 2 sqrt(6) times the inscribed radius 3 V / (sum of the faces' areas); the
/// regular tetrahedron has the radius edge / (2 sqrt 6).
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

/// Returns the vertex of a surface that is farthest from all nodes.
Vec3 farthest_vertex(const TriMesh& surface, const TetMesh& mesh) {
  Vec3 out = Vec3::Zero();
  double most = -1;
  for (const auto& p : surface.vertices.colwise()) {
    const double d =
        mesh.nodes.cols() > 0 ? (mesh.nodes.colwise() - p).colwise().squaredNorm().minCoeff() : 0;
    if (d <= most) continue;
    most = d;
    out = p;
  }
  return out;
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
               const std::string& source, const TriMesh& surface) {
  if (quality.tetrahedra == 0) {
    const Vec3 at = farthest_vertex(surface, mesh);
    fail(
        "{}: no tetrahedron was made; the surface is too thin for this element size, at ({:.4g}, {:.4g}, "
        "{:.4g}) m and everywhere: increase --tetrahedra",
        source, at.x(), at.y(), at.z());
  }
  if (!(quality.smallest_dihedral_deg >= gate.smallest_dihedral_deg)) {
    const Vec3 at = middle(mesh, quality.worst_tet);
    fail(
        "{}: tetrahedron {} at ({:.4g}, {:.4g}, {:.4g}) m has a dihedral angle of {:.2f} degrees, must have "
        "at least {:g}; {}",
        source, quality.worst_tet, at.x(), at.y(), at.z(), quality.smallest_dihedral_deg,
        gate.smallest_dihedral_deg,
        gate.given ? "refill its boundary with --remesh, or accept the tetrahedra with --accept-angles, "
                     "which prints what they cost"
                   : "change --tetrahedra, or smooth the surface there");
  }
  if (!(quality.volume_error <= gate.volume_error)) {
    const Vec3 at = farthest_vertex(surface, mesh);
    fail(
        "{}: the tetrahedra fill {:.6g} m^3 of the surface's {:.6g} m^3, an error of {:.2f} %, must be "
        "within {:g} %; increase --tetrahedra; the largest gap is at ({:.4g}, {:.4g}, {:.4g}) m",
        source, quality.volume, quality.surface_volume, 100 * quality.volume_error, 100 * gate.volume_error,
        at.x(), at.y(), at.z());
  }
}

// Both tetrahedra are positive, so each lists the shared face outwards as seen from its interior: two on
// different sides list it in opposite orders.
void check_sides(const TetMesh& mesh, const std::string& source) {
  struct Seen {
    int tet;
    bool even;
  };
  std::map<std::array<int, 3>, Seen> seen;
  for (int t = 0; t < static_cast<int>(mesh.tets.cols()); ++t)
    for (const auto& face : mesh::kTetFaces) {
      std::array<int, 3> nodes{mesh.tets(face[0], t), mesh.tets(face[1], t), mesh.tets(face[2], t)};
      bool even = true;
      for (const auto& [i, j] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 1)})
        if (nodes[static_cast<std::size_t>(i)] > nodes[static_cast<std::size_t>(j)]) {
          std::swap(nodes[static_cast<std::size_t>(i)], nodes[static_cast<std::size_t>(j)]);
          even = !even;
        }
      const auto [old, fresh] = seen.emplace(nodes, Seen{t, even});
      if (fresh || old->second.even != even) continue;
      const Vec3 at = middle(mesh, t);
      fail(
          "{}: tetrahedra {} and {} lie on the same side of the face that they share, at ({:.4g}, {:.4g}, "
          "{:.4g}) m: one of them is inverted; repair the file, or refill its boundary with --remesh",
          source, old->second.tet, t, at.x(), at.y(), at.z());
    }
}

}  // namespace palpate::model
