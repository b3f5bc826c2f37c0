#include "mesh/tet_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common_checks.h"
#include "palpate/core/error.h"
#include "palpate/mesh/quality.h"

namespace palpate::mesh {
namespace {

double longest_edge(const TetMesh& mesh, int t) {
  double out = 0;
  for (const auto& [i, j] : kTetEdges)
    out = std::max(out, (mesh.nodes.col(mesh.tets(i, t)) - mesh.nodes.col(mesh.tets(j, t))).norm());
  return out;
}

/// Returns the relative volume that rounding of the coordinates alone gives a flat element: edges have an
/// error of epsilon |x|.
double rounding_volume(const TetMesh& mesh, int t, double longest) {
  double far = 0;
  for (int k = 0; k < 4; ++k) far = std::max(far, mesh.nodes.col(mesh.tets(k, t)).cwiseAbs().maxCoeff());
  return 16 * std::numeric_limits<double>::epsilon() * far / longest;
}

/// Flips elements of negative volume; rejects degenerate ones.  Returns the number flipped.
int orient(TetMesh& mesh, const Provenance& from) {
  int flipped = 0;
  for (int t = 0; t < static_cast<int>(mesh.tets.cols()); ++t) {
    const double longest = longest_edge(mesh, t), volume = tet_volume(mesh, t);
    // 1 for the regular tetrahedron
    const double relative = 6 * std::sqrt(2.0) * volume / (longest * longest * longest);
    if (!(std::abs(relative) > std::max(kDegenerateTet, rounding_volume(mesh, t, longest))))
      fail("{} is degenerate: volume = {:.3g} m^3 with edges up to {:.3g} m; remove it or mesh again",
           from.element(t), volume, longest);
    if (volume > 0) continue;
    std::swap(mesh.tets(2, t), mesh.tets(3, t));
    ++flipped;
  }
  return flipped;
}

struct Side {
  std::array<int, 3> nodes;
  int tet;
  auto operator<=>(const Side&) const = default;
};

/// Rejects three elements on one face, which overlap; a face has at most one element on each side.
void refuse_crowded_faces(const Tets& tets, const Provenance& from) {
  std::vector<Side> sides;
  sides.reserve(4 * static_cast<std::size_t>(tets.cols()));
  for (int t = 0; t < static_cast<int>(tets.cols()); ++t)
    for (const auto& face : kTetFaces) {
      Side side{{tets(face[0], t), tets(face[1], t), tets(face[2], t)}, t};
      std::sort(side.nodes.begin(), side.nodes.end());
      sides.push_back(side);
    }
  std::sort(sides.begin(), sides.end());
  for (std::size_t i = 2; i < sides.size(); ++i)
    if (sides[i - 2].nodes == sides[i].nodes)
      fail("{} is the third element on the face of {}, {}, {}; elements overlap there, mesh again",
           from.element(sides[i].tet), from.node_name(sides[i].nodes[0]), from.node_name(sides[i].nodes[1]),
           from.node_name(sides[i].nodes[2]));
}

}  // namespace

MeshReport check_tets(TetMesh& mesh, const Provenance& from) {
  if (mesh.tets.cols() == 0)
    fail("{}: the mesh has no tetrahedra; mesh the volume (in Gmsh: -3), not only its surface", from.source);
  refuse_non_finite(mesh.nodes, from);
  refuse_repeated_nodes(mesh.tets, from);
  refuse_duplicates(mesh.tets, from);
  const int flipped = orient(mesh, from);
  refuse_crowded_faces(mesh.tets, from);
  refuse_unreferenced(mesh.nodes.cols(), mesh.tets, from,
                      "belongs to no tetrahedron; delete such nodes (in Gmsh: put the volume in a Physical "
                      "Volume and save only that)");
  MeshReport report = measure(mesh);
  report.flipped = flipped;
  return report;
}

}  // namespace palpate::mesh
