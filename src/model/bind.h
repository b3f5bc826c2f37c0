#pragma once
#include <vector>

#include "palpate/mesh/mesh.h"
#include "palpate/mesh/skeleton.h"

namespace palpate::model {

/// Returns the distance from a point to a bone's surface [m], negative inside.  The bone is the union of all
/// balls between its two ends, with linearly varying radius.  Exact outside.  If one end's ball contains the
/// other, the distance is measured to that ball.
double distance_to_bone(const Bone& bone, const Vec3& p);

/// Returns the bone that carries each node: the nearest bone that contains it or is nearer than `margin`; -1:
/// tissue.  A bone too thin for the mesh, with no node inside or within the margin, takes the nearest free
/// node, so that every bone is attached.
/// @param margin  [m], not negative
std::vector<int> bind_nodes(const Points& nodes, const Skeleton& skeleton, double margin = 0.0);

}  // namespace palpate::model
