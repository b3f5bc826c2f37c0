#include "loop/one_axis_loop.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "haptic_loop.h"
#include "palpate/core/error.h"

// Performs the same operations per tick as a run, with one axis of a device. The device starts at half of its
// equilibrium under the arm's force, with tool and coupling in the corresponding positions. A decaying motion
// then stays in contact, so that the one-sided wall acts as a linear one and linear theory applies; a growing
// one leaves it.
//
// Growth is measured by the deflection of the coupling, minus its equilibrium value, between the second and
// the last quarter: it decreases if the loop is stable.

namespace palpate::loop {
namespace {

constexpr double kUnlimited = 1e9;   ///< Limit of the limiter, which is not part of the linear loop [N].
constexpr double kHeld = 1e12;       ///< Mass of a fixed tool [kg].
constexpr double kPerturbed = 1e-5;  ///< Initial deflection without a wall [m].

/// Device with one axis, x of the scene, exact between ticks; its velocity is the backward difference.
class AxisHandle : public device::Device {
 public:
  AxisHandle(const OneAxisLoop& loop, double force)
      : axis_(loop.device.arm()),
        tick_(loop.tick_s),
        force_(force),
        held_(static_cast<std::size_t>(loop.delay_ticks) + 1, 0.0) {}
  /// Sets the position, at rest, with a constant past force of the motors.
  void place(double x, double motors) {
    axis_.place(x, 0.0);
    std::fill(held_.begin(), held_.end(), motors);
  }
  device::DeviceSpecification specification() const override { return {}; }
  device::HandleSample do_sample(double t) override {
    const double before = axis_.x();
    if (t > time_) {
      const double F = held_.front() + force_;
      std::rotate(held_.begin(), held_.begin() + 1, held_.end());
      axis_.advance(tick_, F, F);
      time_ = t;
    }
    device::HandleSample out;
    out.pose.translation.x() = axis_.x();
    out.twist.linear.x() = (axis_.x() - before) / tick_;
    return out;
  }
  void do_feedback(double, const Wrench& on_hand) override { held_.back() = on_hand.force.x(); }

 private:
  device::ArmAxis axis_;
  double tick_, force_, time_ = 0.0;
  std::vector<double> held_;  ///< Forces of the motors; the first acts until the next sample.
};

ToolSpec spec_of(const OneAxisLoop& loop) {
  ToolSpec spec;
  spec.mass_kg = loop.tool_held ? kHeld : loop.tool_mass_kg;
  spec.coupling.stiffness_n_m = loop.coupling_stiffness_n_m;
  spec.coupling.damping_n_s_m = loop.coupling_damping_n_s_m;
  spec.tick_s = loop.tick_s;
  spec.integrator = loop.tool_integrator;
  return spec;
}

/// Returns the contact record of the wall, which occupies x > 0.
dynamics::LinearisedContact wall_at(const OneAxisLoop& loop, double tool_x) {
  dynamics::LinearisedContact record;
  record.version = 1;
  if (loop.tool_held || loop.contact_stiffness_n_m <= 0.0 || tool_x <= 0.0) return record;
  constexpr std::size_t kXX = 3 * 6 + 3;
  record.J[kXX] = -loop.contact_stiffness_n_m;
  record.B[kXX] = -loop.contact_damping_n_s_m;
  record.source = dynamics::LinearisedContact::Source::kFrozen;
  return record;
}

}  // namespace

VirtualWallResult simulate_virtual_wall(const OneAxisLoop& loop, double duration_s, double force_n) {
  const ToolSpec spec = spec_of(loop);
  const bool pressed = !loop.tool_held && loop.contact_stiffness_n_m > 0.0;
  const double k = loop.coupling_stiffness_n_m, K = loop.contact_stiffness_n_m;
  const double yielding = pressed ? 1.0 / K + 1.0 / k : 0.0;
  // Equilibrium of arm spring and wall; the coupling carries the force that the arm spring does not.
  const double x_end = pressed ? force_n / (1.0 / yielding + loop.device.arm_stiffness_n_m) : 0.0,
               carried = pressed ? x_end / yielding : 0.0;

  auto handle = std::make_unique<AxisHandle>(loop, pressed ? force_n : 0.0);
  handle->place(pressed ? 0.5 * x_end : kPerturbed, pressed ? -0.5 * carried : 0.0);
  const DeviceSpec device;
  ToolInstance instance{.name = "tool",
                        .spec = spec,
                        .device_spec = device,
                        .device = std::move(handle),
                        .limiter = {kUnlimited, kUnlimited, 0.0},
                        .scheme = PartitionedTool{.tool = {spec, Vec3::Zero()}, .path = {}}};
  tool::Tool& tool = instance.partitioned()->tool;
  if (pressed) tool.set_state(0.0, {Quat::Identity(), Vec3(0.5 * carried / K, 0, 0)}, {});

  HapticLoop ticks(instance);
  ticks.start(0.0);
  instance.limiter.limit(0.0, {}, true);  // its first output is zero, whatever is requested
  const int count = static_cast<int>(std::ceil(duration_s / loop.tick_s));
  PALPATE_CHECK(count >= 8, "{} ticks are too few to measure growth; at least 8 are needed", count);
  VirtualWallResult out;
  double second = 0.0, last = 0.0;
  for (int i = 1; i <= count; ++i) {
    TickRecord tick;
    const auto status =
        ticks.tick(i * loop.tick_s, loop.tick_s, wall_at(loop, tool.pose().translation.x()), tick);
    const double deflection = (tick.handle.translation - tick.tool.translation).x() - carried / k;
    out.largest_force = std::max(out.largest_force, std::abs(tick.device.force.x()));
    if (!status.ok() || !(std::abs(deflection) < 1e3 * std::max(x_end, kPerturbed))) {
      out.growth = 1e3;
      return out;
    }
    if (4 * i > count && 2 * i <= count) second = std::max(second, std::abs(deflection));
    if (4 * i > 3 * count) last = std::max(last, std::abs(deflection));
  }
  const double rounding = 1e-9 * std::max(x_end, kPerturbed);
  out.growth = second > 0.0 ? last / second : 0.0;
  out.stable = last < second || last < rounding;
  return out;
}

}  // namespace palpate::loop
