// Energy at a device's port as printed by a run, against a computation from its haptic.h5: handle positions,
// and the forces sent to the motors, delayed by whole ticks, quantised and saturated.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "loop/haptic_record.h"
#include "palpate/loop/run.h"
#include "temporary_folder.h"

namespace palpate {
namespace {

using Mode = device::PassivityController::Mode;
constexpr double kTick = 1e-3;

/// A hand that strokes a stiff wall with a flat tool.
scene::Description stroked_wall(int delay_ticks, double coupling_damping) {
  scene::Description d;
  d.name = "stroked wall";
  d.duration_s = 0.5;
  d.tool.emplace();
  d.tool->shape = ToolShape::kMesh;
  d.tool->mesh.generator = "box";
  d.tool->mesh.size_m = Vec3::Constant(0.02);
  d.tool->mesh.element_size_m = 0.01;
  d.tool->mass_kg = 0.005;
  d.tool->inertia_kg_m2 = Vec3::Constant(1e-5);
  d.tool->position_m = Vec3(0, 0, 0.011);
  d.tool->tick_s = kTick;
  d.tool->coupling.stiffness_n_m = 1e5;
  d.tool->coupling.damping_n_s_m = coupling_damping;
  d.obstacles.resize(1);
  d.obstacles[0].name = "wall";
  d.obstacles[0].type = "plane";
  d.contacts.resize(1);
  d.contacts[0] = {.first = "tool", .second = "wall", .stiffness_pa_m = 1.5e6};
  DeviceSpec& device = d.device.emplace();
  device.type = "hand";
  device.device_mass_kg = 0.045;
  device.device_damping_n_s_m = 0.6;
  device.arm_mass_kg = 0.05;
  device.arm_damping_n_s_m = 20.0;
  device.arm_stiffness_n_m = 2000.0;
  device.delay_s = delay_ticks * kTick;
  device.max_force_n = 1e6;
  device.max_force_slew_n_s = 1e12;
  device.ramp_s = 0.0;
  for (int i = 0; i <= 10; ++i) {
    KeyframeSpec key;
    key.time_s = 0.05 * i;
    key.position_m = Vec3(0, 0, i % 2 ? 0.005 : 0.011);
    device.keyframes.push_back(key);
  }
  return d;
}

struct KeptRun {
  loop::PortEnergy printed;
  loop::HapticRecord record;
};

KeptRun run(const scene::Description& d, Mode mode) {
  const TemporaryFolder folder;
  const std::string path = folder / "port.h5";
  const auto world = loop::assemble(d);
  loop::RunResult result;
  {
    loop::HapticRecorder recorder(path);
    loop::RunOptions options;
    options.passivity = mode;
    options.observers = {&recorder};
    result = loop::run(*world, options);
  }
  EXPECT_TRUE(result.status.ok());
  return {result.port.value(), loop::read_haptic_record(path)};
}

struct Recomputed {
  double energy = 0.0, least = 0.0, work = 0.0;
};

/// Computes the energy from the forces that were sent.
Recomputed recompute(const std::vector<loop::TickRecord>& ticks, const DeviceSpec& device) {
  const auto delay = static_cast<std::size_t>(std::lround(device.delay_s / kTick));
  const double step = device.force_resolution_n, r = device.encoder_resolution_m.value_or(0.0);
  Recomputed out;
  for (std::size_t k = 1; k < ticks.size(); ++k) {
    Vec3 f = Vec3::Zero(), m = Vec3::Zero();
    if (k >= 1 + delay) {
      f = ticks[k - 1 - delay].device.force;
      m = ticks[k - 1 - delay].device.moment;
    }
    for (double& one : f)
      if (step > 0.0) one = step * std::round(one / step);
    if (f.norm() > *device.max_force_n) f *= *device.max_force_n / f.norm();
    EXPECT_LE((ticks[k].motors.force - f).norm(), 1e-9) << "the recorded one, tick " << k;
    const Vec6 D = pose_difference(ticks[k - 1].handle, ticks[k].handle);
    const double in = -f.dot(D.tail<3>()) - m.dot(D.head<3>());
    out.work += std::abs(in);
    out.energy += in;
    for (const double d : D.tail<3>())
      out.energy += *device.device_damping_n_s_m * std::pow(std::max(0.0, std::abs(d) - r), 2) / kTick;
    out.least = std::min(out.least, out.energy);
  }
  return out;
}

void expect_recomputed(const scene::Description& d, Mode mode, KeptRun* out = nullptr) {
  const KeptRun kept = run(d, mode);
  const Recomputed recomputed = recompute(kept.record.ticks, *d.device);
  EXPECT_GT(kept.printed.work, 1e-5);
  EXPECT_NEAR(kept.printed.energy, recomputed.energy, 1e-9 * recomputed.work);
  EXPECT_NEAR(kept.printed.least, recomputed.least, 1e-9 * recomputed.work);
  EXPECT_NEAR(kept.printed.work, recomputed.work, 1e-9 * recomputed.work);
  if (out) *out = kept;
}

TEST(PortEnergy, IsThatOfTheForceThatTheMotorsHold) {
  int active = 0;
  for (int delay = 0; delay <= 10; ++delay)
    for (const Mode mode : {Mode::kObserve, Mode::kControl}) {
      SCOPED_TRACE(fmt::format("delay of {} ticks, mode {}", delay, static_cast<int>(mode)));
      KeptRun kept;
      expect_recomputed(stroked_wall(delay, 10.0), mode, &kept);
      if (mode == Mode::kObserve)
        active += kept.printed.least < -1e-5;
      else
        EXPECT_GE(kept.printed.least, -1e-6);
    }
  EXPECT_GE(active, 8) << "delayed walls give energy";
}

TEST(PortEnergy, IsThatOfForcesInStepsAndAtTheMaximum) {
  for (const Mode mode : {Mode::kObserve, Mode::kControl})
    for (const int delay : {0, 3}) {
      SCOPED_TRACE(fmt::format("delay of {} ticks, mode {}", delay, static_cast<int>(mode)));
      scene::Description d = stroked_wall(delay, 2.0);
      d.device->force_resolution_n = 0.05;
      d.device->max_force_n = 1.02;
      d.device->encoder_resolution_m = 1e-5;
      expect_recomputed(d, mode);
    }
}

}  // namespace
}  // namespace palpate
