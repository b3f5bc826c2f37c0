#pragma once
#include "palpate/mesh/mesh.h"

namespace palpate::mesh {

/// Returns A / integral of H dA over a closed surface, with the mean curvature H: the radius of a ball, 0.64
/// edges of a cube [m].  Infinite if the integral is not positive.
double mean_radius(const TriMesh& closed);

}  // namespace palpate::mesh
