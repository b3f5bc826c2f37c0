#pragma once
#include "palpate/device/device.h"
#include "palpate/dynamics/path.h"
#include "tool/rigid_block.h"

namespace palpate::loop {

/// Motion of a sampled handle over one step, as a coupling in the State reads it: cubic Hermite interpolation
/// between the samples at both ends, held beyond them. An integrator that evaluates the coupling at the end
/// of the step gets the newest sample.
class SampledHandle {
 public:
  /// Sets the samples at the start t0 and at the end t1 of a step [s]. Equal times hold the handle at
  /// `end`.
  void set(double t0, const device::HandleSample& start, double t1, const device::HandleSample& end) {
    t0_ = t0;
    t1_ = t1;
    start_ = {start.pose, start.twist};
    end_ = {end.pose, end.twist};
  }
  /// Returns the motion of the handle at time t [s].
  tool::HandleState at(double t) const {
    if (t >= t1_) return {end_.pose, end_.twist};
    if (t <= t0_) return {start_.pose, start_.twist};
    const dynamics::RigidMotion m =
        dynamics::motion_between(start_, end_, t1_ - t0_, (t - t0_) / (t1_ - t0_));
    return {m.pose, m.twist};
  }

 private:
  double t0_ = 0.0, t1_ = 0.0;
  dynamics::RigidMotion start_, end_;
};

}  // namespace palpate::loop
