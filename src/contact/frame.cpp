#include "palpate/contact/frame.h"

#include <algorithm>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/dynamics/path.h"

namespace palpate::contact {
namespace {

class FixedFrame final : public MovingFrame {
 public:
  explicit FixedFrame(const Pose& pose) : pose_(pose) {}
  Pose pose(const dynamics::StateView&) const override { return pose_; }
  Twist twist(const dynamics::StateView&) const override { return {}; }
  bool moves() const override { return false; }

 private:
  Pose pose_;
};

class BlockFrame final : public MovingFrame {
 public:
  explicit BlockFrame(int block_id) : block_id_(block_id) {}
  // Trial quaternions of an integrator are not exactly normalised; the rotation is taken from their
  // direction.
  Pose pose(const dynamics::StateView& state) const override {
    const double* q = state.q.data() + block(state).q_offset;
    return {Quat(q[0], q[1], q[2], q[3]).normalized(), Vec3(q[4], q[5], q[6])};
  }
  Twist twist(const dynamics::StateView& state) const override {
    const double* u = state.u.data() + block(state).u_offset;
    return {Vec3(u[0], u[1], u[2]), Vec3(u[3], u[4], u[5])};
  }
  bool in_state() const override { return true; }
  int u_offset(const dynamics::StateView& state) const override { return block(state).u_offset; }

 private:
  const dynamics::Block& block(const dynamics::StateView& state) const {
    const dynamics::Block* b = state.layout->find(block_id_);
    PALPATE_CHECK(b && b->q_size == 7 && b->u_size == 6, "block {} is not a free rigid body of this State",
                  block_id_);
    return *b;
  }
  int block_id_;
};

/// Extrapolates the motion with one knot's twist.
Pose continued(const Pose& pose, const Twist& twist, double dt) {
  return {(quaternion_of(dt * twist.angular) * pose.rotation).normalized(),
          pose.translation + dt * twist.linear};
}

/// Returns the knot at or before t, or the first knot.
template <class Knots>
std::size_t knot_before(const Knots& knots, double t) {
  PALPATE_CHECK(!knots.empty(),
                "pose of a trajectory frame requested at t = {}, before any knot was appended", t);
  const auto after = std::upper_bound(knots.begin(), knots.end(), t,
                                      [](double value, const auto& k) { return value < k.t; });
  return after == knots.begin() ? 0 : static_cast<std::size_t>(after - knots.begin()) - 1;
}

template <class Knots>
dynamics::RigidMotion sample(const Knots& knots, double t) {
  const std::size_t i = knot_before(knots, t);
  const auto& a = knots[i];
  if (t <= a.t || i + 1 == knots.size()) return {continued(a.pose, a.twist, t - a.t), a.twist};
  const auto& b = knots[i + 1];
  const double h = b.t - a.t;
  return dynamics::motion_between({a.pose, a.twist}, {b.pose, b.twist}, h, (t - a.t) / h);
}

}  // namespace

std::shared_ptr<MovingFrame> fixed_frame(const Pose& pose) { return std::make_shared<FixedFrame>(pose); }
std::shared_ptr<MovingFrame> block_frame(int block_id) { return std::make_shared<BlockFrame>(block_id); }

void TrajectoryFrame::clear() { knots_.clear(); }

void TrajectoryFrame::restart() {
  if (knots_.size() > 1) knots_.erase(knots_.begin(), knots_.end() - 1);
}

const TrajectoryFrame::Knot& TrajectoryFrame::last() const {
  PALPATE_CHECK(!knots_.empty(), "last knot of a trajectory frame without knots requested");
  return knots_.back();
}

void TrajectoryFrame::append(double t, const Pose& pose, const Twist& twist) {
  PALPATE_CHECK(knots_.empty() || t > knots_.back().t,
                "knot at t = {} must be later than the previous knot at t = {}", t, knots_.back().t);
  knots_.push_back({t, pose, twist});
}

Pose TrajectoryFrame::pose(const dynamics::StateView& state) const { return sample(knots_, state.time).pose; }
Twist TrajectoryFrame::twist(const dynamics::StateView& state) const {
  return sample(knots_, state.time).twist;
}

}  // namespace palpate::contact
