#pragma once
#include <vector>

#include "palpate/mesh/mesh.h"
#include "palpate/mesh/skeleton.h"

namespace palpate::model {

/// Distance from a point to a bone's surface [m], negative inside: the bone is the union of all balls between
/// its two ends, radii going linearly with the place. Exact outside unless one end's ball holds the other,
/// where it is that ball's.
double distance_to_bone(const Bone& bone, const Vec3& p);

/// The bone that carries each node: the nearest one of those that hold it, or, where `margin` allows, are
/// nearer than that; -1: tissue. A bone too thin for the mesh, with no node inside or within the margin,
/// takes the node nearest to it, so that none hangs loose.
/// @param margin  [m], not negative
std::vector<int> bind_nodes(const Points& nodes, const Skeleton& skeleton, double margin = 0.0);

}  // namespace palpate::model
