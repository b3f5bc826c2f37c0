#pragma once
#include <vector>

#include "mesh/layered_model.h"

namespace palpate::proxy {

/// Returns the bone whose capsule is nearest to each point; 0 everywhere without a skeleton.
std::vector<int> nearest_bone(const Skeleton& skeleton, const Points& points);

/// Cuts each group of skin vertices into clusters that are compact in position and normal: about `count` in
/// all, divided by area, at least one per group.
/// @return the cluster of each vertex, numbered from 0 without gaps, group by group
std::vector<int> skin_clusters(const TriMesh& skin, const std::vector<int>& group_of_vertex, int count,
                               double normal_weight);

}  // namespace palpate::proxy
