#pragma once
#include "mesh/provenance.h"
#include "palpate/mesh/quality.h"

namespace palpate::mesh {

/// A tetrahedron is degenerate if its relative volume 6 sqrt(2) |V| / (longest edge)^3, which is 1 for the
/// regular tetrahedron, is at most this bound, or at most the rounding error of its coordinates.  A sliver
/// with dihedral angles of 0.1 degree has about 2e-3 and is accepted.
inline constexpr double kDegenerateTet = 1e-9;

/// Reorders the nodes of elements of negative volume, and rejects meshes that cannot be simulated: no
/// elements, non-finite coordinates, degenerate or duplicate elements, three elements on one face,
/// unreferenced nodes.
/// @pre every index in mesh.tets lies in [0, number of nodes).
/// @throws Error with the place of the first defect
MeshReport check_tets(TetMesh& mesh, const Provenance& from);

}  // namespace palpate::mesh
