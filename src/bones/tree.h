#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/bones/spec.h"
#include "palpate/dynamics/driven_motion.h"
#include "palpate/dynamics/rigid_body.h"

/// Bones on joints as one block of the State (kind kArticulated), in reduced coordinates by Simbody, so that
/// joints hold exactly.
namespace palpate::bones {

/// One bone at the start, in world axes.  Its frame has the origin at its centre of mass and principal axes.
struct TreeBone {
  std::string name;
  int parent = -1;  ///< index of an earlier bone; -1: the ground
  /// Joint to the parent, with coordinates q and speeds u: a hinge has an angle and its rate; a ball a
  /// quaternion and the angular velocity, in the axes that move with the parent (world axes at the start); a
  /// free bone (quaternion, position of its origin) and (angular, linear velocity), world axes.
  JointType joint = JointType::kBall;
  Pose start;                          ///< pose of its frame
  double mass = 0.0;                   ///< [kg]
  Vec3 inertia = Vec3::Zero();         ///< principal moments [kg m^2]
  Vec3 joint_position = Vec3::Zero();  ///< [m]; unused for a free root
  Vec3 axis = Vec3::UnitZ();           ///< axis of a hinge
  /// Stiffness of a hinge or ball: moment -k theta, with theta the rotation vector from the start [N m/rad].
  double stiffness = 0.0;
  double damping = 0.0;  ///< moment -c u [N m s/rad]
};

/// Constant forces on a bone: their sum F, and S = sum r f^T about the bone's origin, world axes.
struct ConstantForce {
  Vec3 force = Vec3::Zero();   ///< [N]
  Mat3 moment = Mat3::Zero();  ///< [N m]
};

/// The tree as a Simbody system.  All functions take the block's q and u; the last results are cached, so
/// that a second call with equal arguments costs nothing.  Not thread-safe, const members included.
class BoneTree {
 public:
  /// Builds the system.
  /// @param gravity  [m/s^2], world axes
  /// @throws Error for a free joint of a bone with a parent, a hinge without an axis, or invalid masses,
  ///   moments or coefficients
  BoneTree(std::vector<TreeBone> bones, const Vec3& gravity);
  ~BoneTree();
  BoneTree(const BoneTree&) = delete;
  BoneTree& operator=(const BoneTree&) = delete;

  int size() const;  ///< number of bones
  const TreeBone& bone(int i) const;
  int q_size() const;
  int u_size() const;
  VecX start() const;  ///< q at the start
  /// Returns u for a motion of the whole tree as one rigid body about `centre`.  Only free roots can follow
  /// it; the speeds of all other joints are zero.
  VecX rigid_start(const Vec3& velocity, const Vec3& angular_velocity, const Vec3& centre) const;
  /// Returns the specification of the tree's block.
  /// @param length, speed  scales for error control [m], [m/s]: an angle counts as `length`.  Entries of q
  ///   share one scale, so a length below one metre applies to the root's position too.
  dynamics::BlockSpec block(std::string name, double length, double speed) const;

  /// Returns pose and twist of a bone.
  dynamics::RigidMotion motion(const VecX& q, const VecX& u, int bone) const;
  /// Returns the matrix from u to the (angular, linear) velocity of the bone's origin, 6 x u_size.
  Eigen::Ref<const MatX> jacobian(const VecX& q, const VecX& u, int bone) const;
  /// Returns the (angular, linear) acceleration of the bone's origin at u' = 0.
  Vec6 bias(const VecX& q, const VecX& u, int bone) const;
  /// Returns the mass matrix M, u_size x u_size.
  const MatX& mass(const VecX& q) const;
  /// Returns f of M u' = f: weight, gyroscopic and centrifugal forces, joint springs and dampers.
  VecX force(const VecX& q, const VecX& u) const;
  /// Computes A = k_scale K + d_scale D, with K of weight and joints at u = 0 and D of the joints' dampers.
  /// The derivative of gyroscopic forces is omitted, and a ball's spring enters by its symmetric part.
  void tangent(const VecX& q, double k_scale, double d_scale, MatX& A) const;
  /// Adds -d(J^T f)/d(u-directions) of constant forces to K, one force per bone: see tree_geometry.cpp.
  void add_geometric_stiffness(const VecX& q, const std::vector<ConstantForce>& held, MatX& K) const;
  double potential_energy(const VecX& q) const;  ///< energy of weight and joint springs [J]
  double dissipated_power(const VecX& u) const;  ///< power of the joints' dampers [W]

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Makes the mass matrix of the tree's block.
std::shared_ptr<dynamics::InertiaTerm> make_tree_inertia(int block_id, std::shared_ptr<const BoneTree> tree);
/// Makes all forces of the tree's block except the forces that nodes exert on it.
std::shared_ptr<dynamics::ForceTerm> make_tree_force(int block_id, std::shared_ptr<const BoneTree> tree);

/// Makes the motion of nodes that are fixed rigidly to one bone with origin p and velocity (w, v_c) = J u;
/// with r = R l,
///     x = p + r,   v = v_c + w x r,   a = v_c' + w' x r + w x (w x r);
///     row of G for axis k:  e_k^T (J_v - [r]x J_w).
/// @param dofs   degree of freedom of each driven direction
/// @param local  3 x dofs: the node in the bone's frame [m]
std::shared_ptr<dynamics::DrivenMotion> make_tree_carried(std::vector<int> dofs, Points local, int bone,
                                                          int block_id, std::shared_ptr<const BoneTree> tree);

}  // namespace palpate::bones
