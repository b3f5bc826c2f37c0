#include "obstacle_touch.h"

#include "flat_pose.h"

namespace palpate::loop {

ObstacleTouch::ObstacleTouch(double look_ahead_s)
    : look_ahead_(look_ahead_s), motion_(std::make_shared<contact::TrajectoryFrame>()) {
  frame_ = contact_.add_frame(motion_);
}

void ObstacleTouch::place(double t, const dynamics::RigidMotion& tool) {
  motion_->clear();
  motion_->append(t, tool.pose, tool.twist);
  nothing_.set_time(t);
}

void ObstacleTouch::archive(Archive& a, double t, const dynamics::RigidMotion& tool) {
  if (a.gives_back()) place(t, tool);
  due_ = -HUGE_VAL;
  contact_.archive(a, nothing_.view());
}

bool ObstacleTouch::improve(const dynamics::RigidMotion& end) {
  if (!rubs_) return true;
  Vec6 change;
  change << end.twist.angular - start_.twist.angular, end.twist.linear - start_.twist.linear;
  return contact_.improve_step(nothing_.view(), {}, {},
                               {frame_, pose_difference(start_.pose, end.pose), change});
}

void ObstacleTouch::end_tick() {
  if (rubs_) contact_.end_step();
  in_tick_ = rubs_ = false;
}

// The record R(t, x, v) is linear about (x0, v0); it goes on about (x, v) = now with the same F1, J and B:
//     R(t + s, x + dx, v + dv) = R(t, x, v) + s F1 + J dx + B dv,
// up to the second order in the rotation from x0.  To it come the obstacles' F, -K and -B, about (x, v).
dynamics::LinearisedContact ObstacleTouch::with(const dynamics::LinearisedContact& record, double t,
                                                const dynamics::RigidMotion& tool) {
  place(t, tool);
  // ticks add their lengths up: a query is due at the tick next to its time
  if (t >= due_ - 1e-6 * look_ahead_) {
    contact_.refresh(nothing_.view());
    due_ = t + look_ahead_;
  }
  if (!in_tick_) {
    in_tick_ = true;
    start_ = tool;
    rubs_ = contact_.begin_step(nothing_.view());
  }
  contact_.linearise(nothing_.view(), frame_, linear_, contact::Partners::kFrames);
  if (linear_.active == 0) return record;
  dynamics::LinearisedContact out = record;
  Vec6 wrench;
  wrench << linear_.wrench.moment, linear_.wrench.force;
  using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  out.time = t;
  out.x0 = flat(tool.pose);
  Eigen::Map<Vec6>(out.v0.data()) << tool.twist.angular, tool.twist.linear;
  Eigen::Map<Vec6>(out.F0.data()) = dynamics::contact_wrench(record, t, tool.pose, tool.twist) + wrench;
  Eigen::Map<RowMajor6>(out.J.data()) -= linear_.K;
  Eigen::Map<RowMajor6>(out.B.data()) -= linear_.B;
  out.samples += linear_.active;
  if (out.source == dynamics::LinearisedContact::Source::kNone)
    out.source = dynamics::LinearisedContact::Source::kFrozen;
  return out;
}

}  // namespace palpate::loop
