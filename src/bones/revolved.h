#pragma once
#include <vector>

#include "palpate/mesh/mesh.h"

namespace palpate::bones {

/// Returns the surface of revolution about z of a profile (radius, z) from the lower pole to the upper one;
/// only the first and last points have radius 0.
TriMesh revolved(const std::vector<Eigen::Vector2d>& profile);

}  // namespace palpate::bones
