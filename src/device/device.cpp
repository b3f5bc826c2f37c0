#include "palpate/device/device.h"

#include "device/check_range.h"
#include "palpate/core/error.h"

namespace palpate::device {

void Device::open() {
  if (open_) return;
  do_open();
  open_ = true;
}

void Device::close() {
  if (!open_) return;
  open_ = false;
  do_close();
}

HandleSample Device::sample(double t) {
  open();
  last_ = do_sample(t);
  time_ = t;
  return last_;
}

void Device::await(double t, const std::atomic<bool>* stop) {
  open();
  do_await(t, stop);
}

bool PoseBounds::hold(const Pose& pose, const Twist& twist) const {
  return (pose.translation - center).stableNorm() <= radius && twist.linear.stableNorm() <= speed &&
         twist.angular.stableNorm() <= rotation;
}

RecordingClock RecordingClock::of(const DeviceSpec& spec) {
  if (spec.time_scale) check_range("time_scale", *spec.time_scale, DeviceRanges::time_scale);
  if (!std::isfinite(spec.time_offset_s)) fail("device: time_offset_s must be a finite number");
  return {spec.time_scale.value_or(1.0), spec.time_offset_s};
}

void Device::archive(Archive& a) {
  PALPATE_CHECK(can_be_archived(), "this device cannot be archived");
  bool was_open = open_;
  a("open", was_open);
  if (was_open) open();
  a("last", last_);
  a("time", time_);
  do_archive(a);
}

void Device::feedback(double t, const Wrench& on_hand) {
  PALPATE_CHECK(open_, "wrench sent to a closed device at t = {}", t);
  do_feedback(t, on_hand);
}

}  // namespace palpate::device
