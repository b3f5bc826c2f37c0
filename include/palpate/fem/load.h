#pragma once
#include "palpate/fem/spec.h"
#include "palpate/mesh/mesh.h"

namespace palpate::fem {

/// Returns the nodal forces [N], 3 x node count, of a uniform traction with the given resultant over the
/// boundary triangles whose three nodes all lie in the box: a third of each triangle's force goes to each of
/// its nodes. `placed`: the mesh at its initial world positions.
/// @throws Error if no triangle lies in the box, or the box or the force is invalid
Points spread_over_boundary(const TetMesh& placed, const LoadSpec& load);

}  // namespace palpate::fem
