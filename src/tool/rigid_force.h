#pragma once
#include "coupling.h"
#include "palpate/dynamics/force_term.h"

namespace palpate::tool {

/// The free rigid body with that block id.  @throws InternalError where there is none
const dynamics::Block& rigid_block_of(const dynamics::StateView& state, int block_id);

/// Its pose and twist.  A trial state's quaternion is not unit to rounding: the rotation is that of its direction.
RigidMotion motion_of(const dynamics::StateView& state, const dynamics::Block& block);

/// R I R^T
Mat3 world_inertia(const Pose& pose, const Vec3& inertia);

/// k_scale K + d_scale D of -omega x (R I R^T omega): see rigid_block.cpp.
Mat6 gyroscopic_tangent(const RigidMotion& motion, const Vec3& inertia, double k_scale, double d_scale);

/// A force on one rigid block alone: its six rows, K and D its own 6x6.
class RigidForce : public dynamics::ForceTerm {
 public:
  explicit RigidForce(int block_id) : block_id_(block_id) {}
  virtual Vec6 force(double t, const RigidMotion& motion) const = 0;
  virtual Mat6 tangent(double t, const RigidMotion& motion, double k_scale, double d_scale) const = 0;

  void add_force(const dynamics::StateView& state, VecX& f) override;
  void add_tangent(const dynamics::StateView& state, double k_scale, double d_scale, dynamics::BorderedMatrix& A) override;
  void apply_tangent(const dynamics::StateView& state, double k_scale, double d_scale, const VecX& x, VecX& y) override;

 protected:
  RigidMotion motion(const dynamics::StateView& state) const;

 private:
  int block_id_;
};

}  // namespace palpate::tool
