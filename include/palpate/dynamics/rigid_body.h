#pragma once
#include <memory>
#include <string>

#include "palpate/core/pose.h"
#include "palpate/dynamics/corner_term.h"
#include "palpate/dynamics/force_term.h"
#include "palpate/dynamics/inertia_term.h"

/// Free rigid body in the State: a bone, or the tool of a monolithic scene.
/// q = (qw qx qy qz px py pz), u = (angular, linear) in world axes; the origin is the centre of mass, the
/// body axes are principal.
namespace palpate::dynamics {

/// Describes the block of a free rigid body. `length` [m] and `speed` [m/s] are the characteristic magnitudes
/// for error control (an angle corresponds to its arc at radius `length`).
BlockSpec rigid_block(std::string name, double length, double speed);

/// Makes the inertia of a free rigid body, M = diag(R I R^T, m), which rotates with the body.
/// @param block_id  the body's block
/// @param mass  m > 0 [kg]
/// @param inertia  principal moments [kg m^2]
/// @throws Error for a mass that is not positive, or principal moments that no body can have
std::shared_ptr<InertiaTerm> make_rigid_inertia(int block_id, double mass, const Vec3& inertia);

/// Makes the gyroscopic moment -omega x (R I R^T omega). Its tangent is unsymmetric and usually small against
/// the others. By default it is left out and the term is declared symmetric; `tangent` includes it.
std::shared_ptr<ForceTerm> make_gyroscopic(int block_id, const Vec3& inertia, bool tangent = false);

/// Makes the weight m g at the centre of mass.
std::shared_ptr<ForceTerm> make_rigid_weight(int block_id, double mass, const Vec3& gravity);

/// Checks the mass and the principal moments of a rigid body.
/// @throws Error for principal moments that no body can have, or a mass that is not positive
void check_inertia(double mass, const Vec3& inertia, const char* where);

/// Pose of a rigid body and its twist.
struct RigidMotion {
  Pose pose;    ///< Pose of the body axes in the world.
  Twist twist;  ///< Twist of the body's origin, world axes.
};

/// Returns the free rigid body with this block id. @throws InternalError where there is none
const Block& rigid_block_of(const StateView& state, int block_id);

/// Returns the pose and twist of a rigid block. The quaternion of a trial state is normalised, as it need not
/// have unit length.
RigidMotion motion_of(const StateView& state, const Block& block);

/// Returns the inertia about the centre of mass in world axes, R I R^T.
Mat3 world_inertia(const Pose& pose, const Vec3& inertia);

/// Returns k_scale K + d_scale D of the gyroscopic moment -omega x (R I R^T omega). Derivation:
/// rigid_force.cpp.
Mat6 gyroscopic_tangent(const RigidMotion& motion, const Vec3& inertia, double k_scale, double d_scale);

/// Force on a single rigid block: six rows, with 6x6 matrices K and D.
class RigidForce : public ForceTerm, public CornerTerm {
 public:
  /// @param block_id  the rigid block that it acts on
  explicit RigidForce(int block_id) : block_id_(block_id) {}
  /// Returns the moment about the origin and the force [N m, N], world axes.
  virtual Vec6 force(double t, const RigidMotion& motion) const = 0;
  /// Returns k_scale K + d_scale D, with K = -dF/dx along (rotation vector, position) and D = -dF/du.
  virtual Mat6 tangent(double t, const RigidMotion& motion, double k_scale, double d_scale) const = 0;

  void add_force(const StateView& state, VecX& f) override;
  void add_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) override;
  void apply_tangent(const StateView& state, double k_scale, double d_scale, const VecX& x, VecX& y) override;

 protected:
  /// Returns the motion of the block at a state.
  RigidMotion motion(const StateView& state) const;

 private:
  int block_id_;
};

}  // namespace palpate::dynamics
