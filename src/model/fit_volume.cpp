#include "fit_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "palpate/mesh/boundary.h"
#include "palpate/mesh/quality.h"

// A mesh whose boundary nodes lie on a curved surface loses volume: the gap g between a flat facet and the
// surface is e^2 / (8 R) in the middle, and edges of a tenth of a limb's radius lose 1 % of its volume.  Let
// d be the movement of the boundary along its normals, linear over each facet.  The d that is nearest to g,
// with the mass matrix lumped, is
//   d_v = (sum over facets around v of integral g phi_v) / (sum of integral phi_v),
// with integrals by the three-point rule (2/3, 1/6, 1/6), exact for quadratics. Where the surface is flat g =
// 0 and nothing moves: the sides of a box stay in place.  The volume is a cubic of the scale s in x_v + s d_v
// n_v; three steps of the secant method meet the target.  Where elements would become too flat, their nodes'
// movement is halved until they are not, and the other nodes compensate for the volume.
namespace palpate::model {
namespace {

constexpr double kReach = 0.5, kFarthest = 0.15;  // in cell sizes

struct Movement {
  mesh::Boundary boundary;
  Points step;  ///< per boundary vertex [m]
};

/// Returns the signed gap along the outward normal at p [m]; 0 if the surface is not found nearby.
double gap(const SurfaceQuery& surface, const Vec3& p, const Vec3& normal, double reach) {
  double best = 0, nearest = reach;
  for (const double side : {1.0, -1.0})
    if (const auto met = surface.crossing(p, p + side * reach * normal))
      if (const double d = (*met - p).norm(); d < nearest) {
        nearest = d;
        best = side * d;
      }
  return best;
}

Movement movement(const FittedMesh& mesh, const SurfaceQuery& surface, double cell_size) {
  Movement out{mesh::boundary(mesh.mesh), {}};
  const TriMesh& skin = out.boundary.surface;
  VecX gaps = VecX::Zero(skin.vertices.cols()), areas = gaps;
  Points normals = Points::Zero(3, skin.vertices.cols());
  for (Eigen::Index f = 0; f < skin.faces.cols(); ++f) {
    const std::array<Vec3, 3> corner{skin.vertices.col(skin.faces(0, f)), skin.vertices.col(skin.faces(1, f)),
                                     skin.vertices.col(skin.faces(2, f))};
    const Vec3 twice_area = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    for (int q = 0; q < 3; ++q) {
      Vec3 p = Vec3::Zero();
      for (int k = 0; k < 3; ++k) p += (k == q ? 2.0 / 3 : 1.0 / 6) * corner[static_cast<std::size_t>(k)];
      const double g = gap(surface, p, twice_area.normalized(), kReach * cell_size),
                   weight = twice_area.norm() / 6;
      for (int k = 0; k < 3; ++k) {
        const double phi = k == q ? 2.0 / 3 : 1.0 / 6;
        gaps[skin.faces(k, f)] += weight * g * phi;
        areas[skin.faces(k, f)] += weight * phi;
      }
    }
    for (int k = 0; k < 3; ++k) normals.col(skin.faces(k, f)) += twice_area;
  }
  out.step.resize(3, skin.vertices.cols());
  for (Eigen::Index v = 0; v < skin.vertices.cols(); ++v) {
    const bool held =
        mesh.on_crease[static_cast<std::size_t>(out.boundary.node_of_vertex[static_cast<std::size_t>(v)])] !=
        0;
    const double d =
        held ? 0.0 : std::clamp(gaps[v] / areas[v], -kFarthest * cell_size, kFarthest * cell_size);
    out.step.col(v) = d * normals.col(v).normalized();
  }
  return out;
}

TetMesh moved(const TetMesh& mesh, const Movement& by, double scale) {
  TetMesh out = mesh;
  for (Eigen::Index v = 0; v < by.step.cols(); ++v)
    out.nodes.col(by.boundary.node_of_vertex[static_cast<std::size_t>(v)]) += scale * by.step.col(v);
  return out;
}

double volume_of(const Movement& by, double scale) {
  TriMesh skin = by.boundary.surface;
  skin.vertices += scale * by.step;
  return mesh::enclosed_volume(skin);
}

double smallest_dihedral(const TetMesh& mesh, int tet) {
  if (mesh::tet_volume(mesh, tet) <= 0) return 0.0;
  const auto angles = mesh::dihedral_angles(mesh, tet);
  return *std::min_element(angles.begin(), angles.end());
}

/// Returns the scale that meets the volume, as nearly as its limits allow.
double scale_for(const Movement& by, double volume) {
  constexpr double kLargestScale = 2.0;
  double s0 = 0.0, v0 = volume_of(by, 0.0), s1 = 1.0, v1 = volume_of(by, 1.0);
  for (int i = 0; i < 3 && v1 != v0; ++i) {
    const double next = std::clamp(s1 + (volume - v1) * (s1 - s0) / (v1 - v0), 0.0, kLargestScale);
    s0 = s1, v0 = v1;
    s1 = next, v1 = volume_of(by, s1);
  }
  return s1;
}

/// Halves the movement of the nodes of elements with angles below `bearable`; returns false if there are
/// none.
bool damp_movement(const TetMesh& moved, double bearable, const std::vector<int>& vertex_of_node,
                   Movement& by) {
  std::vector<char> held(static_cast<std::size_t>(by.step.cols()), 0);
  bool any = false;
  for (int t = 0; t < static_cast<int>(moved.tets.cols()); ++t) {
    if (smallest_dihedral(moved, t) >= bearable) continue;
    any = true;
    for (int k = 0; k < 4; ++k)
      if (const int v = vertex_of_node[static_cast<std::size_t>(moved.tets(k, t))]; v >= 0)
        held[static_cast<std::size_t>(v)] = 1;
  }
  for (Eigen::Index v = 0; v < by.step.cols(); ++v)
    if (held[static_cast<std::size_t>(v)]) by.step.col(v) /= 2;
  return any;
}

}  // namespace

void fit_volume(FittedMesh& mesh, const SurfaceQuery& surface, double cell_size,
                std::optional<double> volume) {
  constexpr int kRounds = 25;
  Movement by = movement(mesh, surface, cell_size);
  std::vector<int> vertex_of_node(static_cast<std::size_t>(mesh.mesh.nodes.cols()), -1);
  for (std::size_t v = 0; v < by.boundary.node_of_vertex.size(); ++v)
    vertex_of_node[static_cast<std::size_t>(by.boundary.node_of_vertex[v])] = static_cast<int>(v);
  double before = std::numbers::pi;
  for (int t = 0; t < static_cast<int>(mesh.mesh.tets.cols()); ++t)
    before = std::min(before, smallest_dihedral(mesh.mesh, t));
  const double bearable = std::min(0.9 * before, 10.0 * std::numbers::pi / 180);
  for (int round = 0; round < kRounds; ++round) {
    TetMesh trial = moved(mesh.mesh, by, volume ? scale_for(by, *volume) : 1.0);
    if (damp_movement(trial, bearable, vertex_of_node, by)) continue;
    mesh.mesh = std::move(trial);
    return;
  }
}

}  // namespace palpate::model
