#pragma once
#include "palpate/fem/spec.h"
#include "palpate/mesh/mesh.h"

namespace palpate::fem {

/// Nodal forces [N] of a uniform traction with the given resultant over the boundary triangles whose three
/// nodes all lie in the box:
/// a third of each triangle's share to each of its nodes.  `placed`: the mesh at its initial world positions.
/// 3 x node count.
/// @throws Error when no triangle lies in the box, or the box or the force is no box or force.
Points spread_over_boundary(const TetMesh& placed, const LoadSpec& load);

}  // namespace palpate::fem
