#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/dynamics/driven_motion.h"
#include "palpate/dynamics/rigid_body.h"

/// Bones on joints as one block of the State (kind kArticulated): reduced coordinates by Simbody, so that no
/// joint ever comes apart.
namespace palpate::bones {

enum class Joint {
  kWeld,   ///< no joint: moves with its parent
  kHinge,  ///< rotates about one axis: q = angle, u = its rate
  /// rotates about a point: q = quaternion, u = angular velocity, in the axes that the parent carries (the
  /// world's at the start)
  kBall,
  kFree,  ///< of a root alone: q = (quaternion, position of its origin), u = (angular, linear), world axes
};

/// One bone as it stands at the start, in world axes.
/// Its own frame has the origin at its centre of mass and principal axes.
struct TreeBone {
  std::string name;
  int parent = -1;  ///< a bone before this one; -1: the ground
  Joint joint = Joint::kBall;
  Pose start;                          ///< of its own frame
  double mass = 0.0;                   ///< [kg]
  Vec3 inertia = Vec3::Zero();         ///< principal [kg m^2]
  Vec3 joint_position = Vec3::Zero();  ///< [m]; a free root has none
  Vec3 axis = Vec3::UnitZ();           ///< of a hinge
  /// stiffness of hinge and ball: moment -k theta, theta the rotation vector from the start [N m/rad]
  double stiffness = 0.0;
  double damping = 0.0;  ///< moment -c u [N m s/rad]
};

/// Constant forces while the tree moves: on each bone their sum F and S = sum r f^T about the bone's origin,
/// world axes.
struct HeldForce {
  Vec3 force = Vec3::Zero();   ///< [N]
  Mat3 moment = Mat3::Zero();  ///< [N m]
};

/// The tree as Simbody sees it.  Every call takes the block's own q and u; the last results are kept, so that
/// a second call with equal arguments costs nothing.
class BoneTree {
 public:
  /// @throws Error for a free joint that is no root's, a hinge without an axis, or numbers that are no body's
  BoneTree(std::vector<TreeBone> bones, const Vec3& gravity);
  ~BoneTree();
  BoneTree(const BoneTree&) = delete;
  BoneTree& operator=(const BoneTree&) = delete;

  int size() const;  ///< bones
  const TreeBone& bone(int i) const;
  int q_size() const;
  int u_size() const;
  VecX start() const;  ///< q at the start
  /// u of a motion of the whole tree as one rigid body, about `centre`; components that the joints cannot
  /// follow are left out.
  VecX rigid_start(const Vec3& velocity, const Vec3& angular_velocity, const Vec3& centre) const;
  /// @param length, speed  sizes that matter to error control: an angle counts as `length`.  Entries of q
  ///   share one scale, so a length of less than a metre applies to the root's position too.
  dynamics::BlockSpec block(std::string name, double length, double speed) const;

  dynamics::RigidMotion motion(const VecX& q, const VecX& u, int bone) const;
  /// (angular, linear) velocity of the bone's origin by u, 6 x u_size.
  Eigen::Ref<const MatX> jacobian(const VecX& q, const VecX& u, int bone) const;
  /// (angular, linear) acceleration of the bone's origin at u' = 0.
  Vec6 bias(const VecX& q, const VecX& u, int bone) const;
  /// M, u_size x u_size.
  const MatX& mass(const VecX& q) const;
  /// f of M u' = f: weight, gyroscopic and centrifugal forces, joints.
  VecX force(const VecX& q, const VecX& u) const;
  /// K of weight and joints at u = 0, and D of the joints' dampers; the derivative of gyroscopic forces is
  /// left out, and a ball's spring enters by its symmetric part.
  void tangent(const VecX& q, double k_scale, double d_scale, MatX& A) const;
  /// K += -d(J^T f)/d(u-directions) of held forces, one a bone: see tree_geometry.cpp.
  void add_geometric_stiffness(const VecX& q, const std::vector<HeldForce>& held, MatX& K) const;
  double potential_energy(const VecX& q) const;  ///< of weight and joints [J]
  double dissipated_power(const VecX& u) const;  ///< by the joints' dampers [W]

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The mass matrix of the tree's block.
std::shared_ptr<dynamics::InertiaTerm> make_tree_inertia(int block_id, std::shared_ptr<const BoneTree> tree);
/// All forces of the tree's block except those that nodes exert on it.
std::shared_ptr<dynamics::ForceTerm> make_tree_force(int block_id, std::shared_ptr<const BoneTree> tree);

/// Nodes fixed rigidly to one bone with origin p and velocity (w, v_c) = J u; with r = R l,
///     x = p + r,   v = v_c + w x r,   a = v_c' + w' x r + w x (w x r);
///     row of G for axis k:  e_k^T (J_v - [r]x J_w).
/// @param local  3 x dofs: the node in the bone's frame [m]
std::shared_ptr<dynamics::DrivenMotion> make_tree_carried(std::vector<int> dofs, Points local, int bone,
                                                          int block_id, std::shared_ptr<const BoneTree> tree);

}  // namespace palpate::bones
