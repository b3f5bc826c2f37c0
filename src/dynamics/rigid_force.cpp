#include "palpate/core/error.h"
#include "palpate/dynamics/rigid_body.h"

namespace palpate::dynamics {

const Block& rigid_block_of(const StateView& state, int block_id) {
  const Block* block = state.layout->find(block_id);
  PALPATE_CHECK(block && block->q_size == 7 && block->u_size == 6, "block {} is not a free rigid body",
                block_id);
  return *block;
}

RigidMotion motion_of(const StateView& state, const Block& block) {
  const auto q = state.q.segment<7>(block.q_offset);
  return {{Quat(q[0], q[1], q[2], q[3]).normalized(), q.tail<3>()},
          {state.u.segment<3>(block.u_offset), state.u.segment<3>(block.u_offset + 3)}};
}

Mat3 world_inertia(const Pose& pose, const Vec3& inertia) {
  const Mat3 R = pose.rotation.toRotationMatrix();
  return R * inertia.asDiagonal() * R.transpose();
}

// f = -w x I w with I = R I0 R^T. With respect to velocity, D = -df/dw = [w] I - [I w]. A rotation e of the
// body changes I to I + [e] I - I [e], so d(I w) = e x I w - I (e x w) = (I [w] - [I w]) e, and K = -df/de =
// [w] (I [w] - [I w]).
Mat6 gyroscopic_tangent(const RigidMotion& m, const Vec3& inertia, double k_scale, double d_scale) {
  Mat6 A = Mat6::Zero();
  const Mat3 I = world_inertia(m.pose, inertia), w = cross_matrix(m.twist.angular),
             L = cross_matrix(I * m.twist.angular);
  A.topLeftCorner<3, 3>() = d_scale * (w * I - L) + k_scale * w * (I * w - L);
  return A;
}

void RigidForce::add_force(const StateView& state, VecX& f) {
  const auto& block = rigid_block_of(state, block_id_);
  f.segment<6>(block.u_offset) += force(state.time, motion_of(state, block));
}

void RigidForce::add_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) {
  const auto& block = rigid_block_of(state, block_id_);
  const int at = block.u_offset - state.layout->nodal_size;
  A.corner.block<6, 6>(at, at) += tangent(state.time, motion_of(state, block), k_scale, d_scale);
}

void RigidForce::apply_tangent(const StateView& state, double k_scale, double d_scale, const VecX& x,
                               VecX& y) {
  const auto& block = rigid_block_of(state, block_id_);
  y.segment<6>(block.u_offset) +=
      tangent(state.time, motion_of(state, block), k_scale, d_scale) * x.segment<6>(block.u_offset);
}

RigidMotion RigidForce::motion(const StateView& state) const {
  return motion_of(state, rigid_block_of(state, block_id_));
}

}  // namespace palpate::dynamics
