#pragma once
#include <memory>
#include <string>

#include "palpate/core/pose.h"
#include "palpate/dynamics/force_term.h"
#include "palpate/dynamics/inertia_term.h"

/// A free rigid body as a block of the State: a bone, or the tool of a monolithic scene.
/// q = (qw qx qy qz px py pz), u = (angular, linear) in world axes; the origin is the centre of mass, the
/// body axes are principal.
namespace palpate::dynamics {

/// The block of that body; `length` [m] and `speed` [m/s] are the sizes that matter to error control (an
/// angle counts as length/`length`).
BlockSpec rigid_block(std::string name, double length, double speed);

/// @param block_id  of the body  @param mass  m > 0 [kg]
/// M = diag(R I R^T, m): rotates with the body.  @param inertia principal moments [kg m^2]  @throws Error for
/// moments that are no body's
std::shared_ptr<InertiaTerm> make_rigid_inertia(int block_id, double mass, const Vec3& inertia);

/// -omega x (R I R^T omega).  Its tangent is unsymmetric and usually small against the rest: left out, and
/// the term symmetric, unless asked for.
std::shared_ptr<ForceTerm> make_gyroscopic(int block_id, const Vec3& inertia, bool tangent = false);

/// m g at the centre of mass.
std::shared_ptr<ForceTerm> make_rigid_weight(int block_id, double mass, const Vec3& gravity);

/// @throws Error for principal moments that are no body's, or a mass that is not positive
void check_inertia(double mass, const Vec3& inertia, const char* where);

/// A pose and its twist.
struct RigidMotion {
  Pose pose;    ///< of the body's axes in the world
  Twist twist;  ///< of its origin, world axes
};

/// The free rigid body with that block id.  @throws InternalError where there is none
const Block& rigid_block_of(const StateView& state, int block_id);

/// Its pose and twist.  A trial state's quaternion is not unit to rounding: the rotation is that of its
/// direction.
RigidMotion motion_of(const StateView& state, const Block& block);

/// R I R^T
Mat3 world_inertia(const Pose& pose, const Vec3& inertia);

/// k_scale K + d_scale D of -omega x (R I R^T omega): see rigid_force.cpp.
Mat6 gyroscopic_tangent(const RigidMotion& motion, const Vec3& inertia, double k_scale, double d_scale);

/// A force on one rigid block alone: its six rows, K and D its own 6x6.
class RigidForce : public ForceTerm {
 public:
  /// @param block_id  the rigid block that it acts on
  explicit RigidForce(int block_id) : block_id_(block_id) {}
  /// Moment about the origin and force [N m, N], world axes.
  virtual Vec6 force(double t, const RigidMotion& motion) const = 0;
  /// k_scale K + d_scale D, K = -dF/dx along (rotation vector, position), D = -dF/du.
  virtual Mat6 tangent(double t, const RigidMotion& motion, double k_scale, double d_scale) const = 0;

  void add_force(const StateView& state, VecX& f) override;
  void add_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) override;
  void apply_tangent(const StateView& state, double k_scale, double d_scale, const VecX& x, VecX& y) override;

 protected:
  /// Of the block at a state.
  RigidMotion motion(const StateView& state) const;

 private:
  int block_id_;
};

}  // namespace palpate::dynamics
