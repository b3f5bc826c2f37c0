#pragma once
#include <vector>

#include "palpate/mesh/mesh.h"

namespace palpate::bones {

/// Surface of revolution about z of a profile (radius, z) from one pole to the other; only the first and last
/// have radius 0.
TriMesh revolved(const std::vector<Eigen::Vector2d>& profile);

}  // namespace palpate::bones
