#include "palpate/dynamics/layout.h"

namespace palpate::dynamics {
namespace {

/// Quaternion rate with world angular velocity w: q' = 1/2 (0, w) q (Shuster 1993). Left inverse: (0, w) = 2
/// q' q* / |q|^2.
class FreeBodyKinematics final : public BlockKinematics {
 public:
  void q_dot(const ConstSegment& q, const ConstSegment& u, Segment out) const override {
    const Quat rotation(q[0], q[1], q[2], q[3]);
    const Quat rate = Quat(0.0, u[0], u[1], u[2]) * rotation;
    out[0] = 0.5 * rate.w();
    out.segment<3>(1) = 0.5 * rate.vec();
    out.segment<3>(4) = u.segment<3>(3);
  }
  void u_of_q_dot(const ConstSegment& q, const ConstSegment& q_dot, Segment u) const override {
    const Quat rotation(q[0], q[1], q[2], q[3]);
    const Quat rate(q_dot[0], q_dot[1], q_dot[2], q_dot[3]);
    u.segment<3>(0) = 2.0 * (rate * rotation.conjugate()).vec() / rotation.squaredNorm();
    u.segment<3>(3) = q_dot.segment<3>(4);
  }
  void project(Segment q) const override { q.head<4>().normalize(); }
};

}  // namespace

std::shared_ptr<const BlockKinematics> free_body_kinematics() {
  static const auto kinematics = std::make_shared<const FreeBodyKinematics>();
  return kinematics;
}

const Block* Layout::find(int id) const {
  for (const Block& b : blocks)
    if (b.id == id) return &b;
  return nullptr;
}

const Block* Layout::find(const std::string& name) const {
  for (const Block& b : blocks)
    if (b.name == name) return &b;
  return nullptr;
}

}  // namespace palpate::dynamics
