#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/dynamics/driven_motion.h"
#include "palpate/dynamics/path.h"
#include "palpate/fem/spec.h"
#include "palpate/mesh/mesh.h"

namespace palpate::fem {

/// Returns the nodes of `placed` (initial world positions [m]) inside the box, its border included to a
/// millionth of the extent of `placed`.
std::vector<int> nodes_in_box(const Points& placed, const Vec3& box_min, const Vec3& box_max);

/// Returns the u indices of the given axes ("x", "xz", "xyz") of nodes, ascending. `first_node`: first
/// node of the body, counted over all node blocks.
/// @throws Error for letters other than x, y, z, repeated letters, or none
std::vector<int> dofs_of_nodes(const std::vector<int>& nodes, int first_node, const std::string& axes);

/// Holds directions of nodes in place: x = x0, v = 0. `dofs` are u indices, ascending; x0 [m] has one entry
/// per dof.
std::shared_ptr<dynamics::DrivenMotion> make_fixed(std::vector<int> dofs, VecX x0);

/// Moves nodes rigidly along a path: x = path(t).pose * p, with p fixed in the path's frame, in the listed
/// dofs (all three axes or some of them).
std::shared_ptr<dynamics::DrivenMotion> make_driven(std::vector<int> dofs, Points local_points_per_dof,
                                                    dynamics::Path path);

/// Returns the nodes of `placed` inside the sphere, its surface included with the tolerance of
/// nodes_in_box().
/// @throws Error for a radius that is not positive
std::vector<int> nodes_in_sphere(const Points& placed, const Vec3& centre, double radius);

/// Attaches nodes rigidly to a free rigid body (block kRigidBody of the State, dynamics/rigid_body.h), in the
/// listed dofs (all three axes or some of them). With the body's pose (p, R), velocity v_c of its origin,
/// angular velocity w, and l fixed in the body, r = R l, world axes throughout:
///     x = p + r,   v = v_c + w x r,   a = v_c' + w' x r + w x (w x r).
/// With u = (w, v_c): v = G u with G = [-[r]x, I], so that the row of axis k is ((r x e_k)^T, e_k^T), and
/// gamma = w x (w x r). A force f on the node is the wrench (r x f, f) on the body: G^T f.
std::shared_ptr<dynamics::DrivenMotion> make_carried(std::vector<int> dofs, Points local_points_per_dof,
                                                     int master_block_id);

}  // namespace palpate::fem
