#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "palpate/core/pose.h"
#include "palpate/dynamics/driven_motion.h"
#include "palpate/fem/spec.h"
#include "palpate/mesh/mesh.h"

namespace palpate::fem {

/// Nodes of `placed` (initial world positions) inside the box, borders included.
std::vector<int> nodes_in_box(const Points& placed, const Vec3& box_min, const Vec3& box_max);

/// The u indices of the named axes ("x", "xz", "xyz") of nodes, ascending; `first_node`: of the body, counted over all node blocks.
/// @throws Error for letters other than x, y, z, repeated ones, or none.
std::vector<int> dofs_of_nodes(const std::vector<int>& nodes, int first_node, const std::string& axes);

/// Holds directions of nodes where they are: x = x0, v = 0.  `dofs` are u indices, ascending; x0 [m] one each.
std::shared_ptr<dynamics::DrivenMotion> make_fixed(std::vector<int> dofs, VecX x0);

/// Position and its first two derivatives of a point path; used for nodes driven by time.
struct PathPoint { Pose pose; Twist twist; Twist acceleration; };
using Path = std::function<PathPoint(double t)>;

/// Moves nodes rigidly with a path: x = path(t).pose * p, with p fixed in the path's frame, all three axes or the listed dofs of them.
std::shared_ptr<dynamics::DrivenMotion> make_driven(std::vector<int> dofs, Points local_points_per_dof, Path path);

}  // namespace palpate::fem
