// Monolithic solution of a simulated hand, its tool and the bodies: the limit of the tick loop.
#include <gtest/gtest.h>

#include "loop/replay.h"
#include "loop/ticks_of.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "small_scenes.h"

namespace {

using namespace palpate;

/// A hand whose arm has a target inside the block, rotated.
scene::Description yielding() {
  scene::Description d = small_scenes::pressed_block(0.0);
  d.bodies[0].mesh.element_size_m = 0.02;
  d.duration_s = 0.15;
  d.device->type = "hand";
  KeyframeSpec down = d.device->keyframes.front();
  down.time_s = 0.1;
  down.position_m += Vec3(0.002, 0.0, -0.008);
  down.rotation_vector_rad = Vec3(0.3, -0.2, 0.4);
  d.device->keyframes.push_back(down);
  d.device->device_damping_n_s_m = 1.0;
  d.integrator.name = "cvode-bdf";
  d.integrator.rtol = 1e-8;
  return d;
}

scene::Description as_one(scene::Description d, double refresh_s = 5e-4) {
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = refresh_s;
  return d;
}

double largest(const std::vector<loop::TickRecord>& ticks) {
  double out = 0.0;
  for (const auto& tick : ticks) out = std::max(out, tick.device.force.norm());
  return out;
}

// The hand yields in depth in proportion to the force: it does not reach the arm's target.
TEST(HandInState, YieldsToTheForce) {
  scene::Description d = as_one(yielding(), 0.005);
  d.duration_s = 0.5;
  d.device->arm_damping_n_s_m = 40.0;  // damped to rest
  const auto ticks = ticks_of(d);
  const loop::TickRecord& end = ticks.back();
  const KeyframeSpec& requested = d.device->keyframes.back();
  EXPECT_GT(end.device.force.z(), 0.1);
  // at rest the arm's spring carries the force on the hand
  const double gives = end.device.force.z() / d.device->arm_stiffness_n_m;
  EXPECT_GT(gives, 1e-4);
  EXPECT_NEAR(end.handle.translation.z() - requested.position_m.z(), gives, 0.02 * gives);
  d.device->arm_stiffness_n_m *= 100.0;
  d.device->arm_damping_n_s_m *= 10.0;
  EXPECT_GT(ticks_of(d).back().device.force.z(), 1.02 * end.device.force.z());
}

// Without bodies, the hand in ticks converges to the monolithic solution with the tick: the hold of the force
// is of first order.
/// @param friction_n  Coulomb friction of the device [N]
void expect_order_one(double friction_n) {
  scene::Description d = yielding();
  d.device->device_friction_n = friction_n;
  d.bodies.clear();
  d.contacts.clear();
  scene::Description one = d;
  one.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  one.integrator.rtol = 1e-10;
  one.tool->tick_s = 1e-3;
  const auto truth = ticks_of(one);
  ASSERT_GT(largest(truth), 0.1);
  std::vector<double> errors;
  for (const double tick : {1e-3, 5e-4, 2.5e-4}) {
    d.tool->tick_s = tick;
    const auto ticks = ticks_of(d);
    const auto stride = static_cast<std::size_t>(std::lround(1e-3 / tick));
    double worst = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const loop::TickRecord& there = ticks.at((i + 1) * stride - 1);
      worst = std::max(worst, (there.handle.translation - truth[i].handle.translation).norm() +
                                  0.02 * pose_difference(there.handle, truth[i].handle).head<3>().norm());
    }
    errors.push_back(worst);
  }
  EXPECT_GT(errors[0], 1e-6);
  for (std::size_t i = 1; i < errors.size(); ++i)
    EXPECT_NEAR(std::log2(errors[i - 1] / errors[i]), 1.0, 0.2) << errors[i];
}

TEST(HandInState, TheLoopOfTicksTendsToIt) {
  expect_order_one(0.0);
  expect_order_one(0.26);
}

// With bodies, the remaining difference at ticks of 1 ms is the error of the exchange.
TEST(HandInState, TheExchangesAreNearIt) {
  scene::Description d = yielding();
  const auto truth = ticks_of(as_one(d));
  std::vector<double> errors;
  for (const double period : {0.01, 0.005, 0.002}) {
    d.exchange.exchange_period_s = d.exchange.contact_refresh_s = period;
    const auto ticks = ticks_of(d);
    ASSERT_EQ(ticks.size(), truth.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < ticks.size(); ++i)
      sum += (ticks[i].device.force - truth[i].device.force).squaredNorm();
    errors.push_back(std::sqrt(sum / static_cast<double>(ticks.size())) / largest(truth));
  }
  EXPECT_LT(errors[1], 0.8 * errors[0]);
  EXPECT_LT(errors[2], 0.8 * errors[1]);
  EXPECT_LT(errors[2], 0.03);
}

// Methods with error control, with Newton iterations and with one linear solve per step integrate the block.
TEST(HandInState, UnderEveryKindOfIntegrator) {
  scene::Description d = as_one(yielding(), 0.002);
  const double force = ticks_of(d).back().device.force.z();
  for (const char* name : {"ida", "ark-dirk-esdirk437", "linearly-implicit-euler", "implicit-midpoint"}) {
    d.integrator.name = name;
    d.integrator.rtol = 1e-6;
    d.integrator.step_s = 5e-4;
    EXPECT_NEAR(ticks_of(d).back().device.force.z(), force, 0.05 * force) << name;
  }
}

TEST(HandInState, AnEnergyBalanceIsRefused) {
  scene::Description d = as_one(yielding());
  d.record.emplace();
  d.record->energy = true;
  EXPECT_THROW(loop::assemble(d), Error);
}

}  // namespace
