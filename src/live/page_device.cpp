#include "live/page_device.h"

#include <utility>

namespace palpate::live {

HandleTarget HandleTarget::of(const Pose& pose, std::uint32_t switches) {
  const Vec3& p = pose.translation;
  const Quat& q = pose.rotation;
  return {{p.x(), p.y(), p.z()}, {q.w(), q.x(), q.y(), q.z()}, switches, true};
}

Pose HandleTarget::pose() const {
  return {Quat(rotation[0], rotation[1], rotation[2], rotation[3]), {position[0], position[1], position[2]}};
}

PageDevice::PageDevice(std::shared_ptr<HandleMailbox> mailbox, const Pose& start,
                       const FollowerLimits& limits)
    : mailbox_(std::move(mailbox)), limits_(limits), follower_(start, limits), start_(start) {}

void PageDevice::start_at(const Pose& start) {
  start_ = start;
  follower_ = HandleFollower(start, limits_);
}

device::DeviceSpecification PageDevice::specification() const {
  device::DeviceSpecification out;
  out.name = "viewer in a browser";
  return out;
}

device::HandleSample PageDevice::do_sample(double t) {
  const HandleTarget& target = mailbox_->latest();
  Pose to = target.given ? target.pose() : start_;
  const Vec3 arm = to.translation - bounds_.center;
  if (const double distance = arm.norm(); distance > bounds_.radius)
    to.translation = bounds_.center + bounds_.radius / distance * arm;
  follower_.advance(started_ ? t - time_ : 0.0, to);
  started_ = true;
  time_ = t;
  device::HandleSample out;
  out.pose = follower_.pose();
  out.twist = follower_.twist();
  out.acceleration = follower_.acceleration();
  out.switches = target.switches;
  return out;
}

}  // namespace palpate::live
