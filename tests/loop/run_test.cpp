#include "palpate/loop/run.h"

#include <gtest/gtest.h>

#include "loop/small_scenes.h"
#include "loop/summary.h"
#include "palpate/core/error.h"
#ifdef PALPATE_HAS_TOOL
#include "palpate/tool/tool.h"
#endif

using namespace palpate;
using namespace palpate::small_scenes;

namespace {

class Log : public loop::Observer {
 public:
  void period(loop::World& world, double t) override {
    periods.push_back(t);
    positions = world.state.q();
  }
  void tick(const loop::TickRecord& tick) override { ticks.push_back(tick); }
  std::vector<double> periods;
  std::vector<loop::TickRecord> ticks;
  VecX positions;
};

loop::RunResult run_with(const scene::Description& d, Log& log, double duration = 0.0) {
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.observers = {&log};
  options.duration_s = duration;
  return loop::run(*world, options);
}

TEST(Run, BodyAtRestStaysAtRestToRounding) {
  Log log;
  const auto world = loop::assemble(held_block());
  const VecX start = world->state.q();
  loop::RunOptions options;
  options.observers = {&log};
  ASSERT_TRUE(loop::run(*world, options).status.ok());
  EXPECT_LT((world->state.q() - start).lpNorm<Eigen::Infinity>(), 1e-15);
  EXPECT_LT(world->mechanical_energy(), 1e-20);
}

TEST(Run, NodalDilatationStepsUnderErrorControlAndWithOneLinearSolveAStep) {
  // Nearly incompressible, released under six times its weight: two integrators of different families must
  // agree.
  scene::Description d = held_block();
  d.gravity_m_s2 = Vec3(0, 20, -60);
  d.bodies[0].poissons_ratio = 0.4999;
  d.bodies[0].volumetric = Volumetric::kNodal;
  const VecX start = loop::assemble(d)->state.q();
  const auto end = [&](const std::string& integrator, double setting) {
    d.integrator.name = integrator;
    (integrator == "cvode-bdf" ? d.integrator.rtol : d.integrator.step_s) = setting;
    Log log;
    EXPECT_TRUE(run_with(d, log).status.ok()) << integrator;
    return VecX(log.positions - start);
  };
  const VecX reference = end("cvode-bdf", 1e-6);
  EXPECT_GT(reference.lpNorm<Eigen::Infinity>(), 1e-3);
  EXPECT_LT((end("cvode-bdf", 1e-4) - reference).norm(), 1e-2 * reference.norm());
  const double coarse = (end("linearly-implicit-euler", 2e-3) - reference).norm(),
               fine = (end("linearly-implicit-euler", 1e-3) - reference).norm();
  EXPECT_LT(fine, 0.1 * reference.norm());
  EXPECT_NEAR(std::log2(coarse / fine), 1.0, 0.3) << "order 1";
}

TEST(Run, StopEndsAfterTheCurrentPeriod) {
  std::atomic<bool> stop{true};
  const auto world = loop::assemble(held_block());
  loop::RunOptions options;
  options.stop = &stop;
  const loop::RunResult result = loop::run(*world, options);
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(result.periods, 0);
  EXPECT_TRUE(result.status.ok());
}

TEST(Run, AnIntegratorThatGivesUpEndsTheRunAsData) {
  scene::Description d = held_block();
  d.gravity_m_s2 = Vec3(0, 0, -10);
  d.integrator.name = "cvode-bdf";
  d.integrator.max_steps = 1;
  Log log;
  const loop::RunResult result = run_with(d, log);
  EXPECT_FALSE(result.status.ok());
  EXPECT_NE(result.status.message.find("cvode-bdf"), std::string::npos) << result.status.message;
  EXPECT_EQ(log.periods.size(), 1u) << "only the start";
}

TEST(Summary, NamesTheLibrariesThatMadeTheResult) {
  const auto world = loop::assemble(held_block());
  const loop::RunResult result = loop::run(*world, {});
  const store::Summary summary = loop::summarise(*world, result, 0.0);
  EXPECT_EQ(summary.outcome, "finished");
  const auto version = [&](const std::string& name) {
    for (const auto& [library, text] : summary.provenance.libraries)
      if (library == name) return text;
    return std::string();
  };
  const std::string sundials = version("SUNDIALS");
  EXPECT_TRUE(sundials.starts_with("6.") || sundials.starts_with("7.")) << sundials;
  EXPECT_FALSE(version("CHOLMOD").empty());
#ifdef PALPATE_HAS_TOOL
  EXPECT_TRUE(version("Simbody").starts_with("3.")) << version("Simbody");
#endif
}

#ifdef PALPATE_HAS_TOOL
TEST(Run, PeriodsAndTicksComeInTheirOrderAndNumber) {
  Log log;
  const loop::RunResult result = run_with(pressed_block(0.001), log);
  ASSERT_TRUE(result.status.ok());
  EXPECT_EQ(result.periods, 4);
  EXPECT_EQ(result.ticks, 40);
  ASSERT_EQ(log.periods.size(), 5u);
  EXPECT_EQ(log.periods.front(), 0.0);
  EXPECT_DOUBLE_EQ(log.periods.back(), 0.04);
  ASSERT_EQ(log.ticks.size(), 40u);
  for (std::size_t i = 0; i < log.ticks.size(); ++i)
    EXPECT_NEAR(log.ticks[i].time, 1e-3 * static_cast<double>(i + 1), 1e-15);
}

TEST(Run, SameSceneSameNumbersBitForBit) {
  Log first, second;
  ASSERT_TRUE(run_with(pressed_block(0.002), first).status.ok());
  ASSERT_TRUE(run_with(pressed_block(0.002), second).status.ok());
  EXPECT_EQ(first.positions, second.positions);
  for (std::size_t i = 0; i < first.ticks.size(); ++i)
    EXPECT_EQ(first.ticks[i].device.force, second.ticks[i].device.force);
}

// Observers change no number; the energy is that of the recorded ticks, and so is the buzz.
TEST(Run, ObservesTheEnergyAtThePort) {
  scene::Description d = pressed_block(0.002);
  d.device->keyframes.push_back({.time_s = 0.03, .position_m = d.tool->position_m - Vec3(0, 0, 0.002)});
  Log off, observed;
  loop::RunResult plain, result;
  for (const bool observe : {false, true}) {
    const auto world = loop::assemble(d);
    loop::RunOptions options;
    options.observers = {observe ? &observed : &off};
    if (observe) options.passivity = device::PassivityController::Mode::kObserve;
    (observe ? result : plain) = loop::run(*world, options);
  }
  EXPECT_FALSE(plain.port.has_value());
  ASSERT_TRUE(result.port.has_value() && result.buzz_n.has_value());
  double energy = 0.0;
  ASSERT_EQ(off.ticks.size(), observed.ticks.size());
  for (std::size_t i = 0; i < off.ticks.size(); ++i) {
    EXPECT_EQ(off.ticks[i].device.force, observed.ticks[i].device.force);
    if (i > 0)
      energy -= off.ticks[i - 1].device.force.dot(off.ticks[i].handle.translation -
                                                  off.ticks[i - 1].handle.translation);
  }
  EXPECT_NEAR(result.port->energy, energy, 1e-12);
  EXPECT_GT(energy, 1e-4);
  EXPECT_GT(result.port->work, 0.0);
  EXPECT_EQ(result.port->controller_dissipated, 0.0);
  EXPECT_GT(*result.buzz_n, 0.0);
  EXPECT_EQ(*result.buzz_n, *plain.buzz_n);
}

// At rest the spring of the hand balances the contact: k (x_h - x_t) + F = 0, and the block carries the same
// force.
TEST(Run, HeldHandleComesToRestInBalanceWithTheBlock) {
  const scene::Description d = pressed_block(0.003);
  const auto world = loop::assemble(d);
  Log log;
  loop::RunOptions options;
  options.observers = {&log};
  options.duration_s = 1.5;
  ASSERT_TRUE(loop::run(*world, options).status.ok());
  const loop::TickRecord& last = log.ticks.back();
  const Vec3 spring = d.tool->coupling.stiffness_n_m * (last.handle.translation - last.tool.translation);
  const Wrench contact = world->contact->frame_wrench(world->state.view(), world->tool_frame_index());
  ASSERT_GT(contact.force.z(), 0.05);
  EXPECT_LT((spring + contact.force).norm(), 1e-6 * contact.force.norm());
  EXPECT_LT((last.device.force + spring).norm(), 1e-2 * spring.norm())
      << "the hand feels the spring, but for the limiter's smooth onset";
  VecX reactions;
  world->system.reactions(world->state.view(), reactions);
  const Vec3 support = Eigen::Map<const Points>(reactions.data(), 3, reactions.size() / 3).rowwise().sum();
  EXPECT_LT((support - contact.force).norm(), 1e-5 * contact.force.norm())
      << "what presses down on the block is held below it";
}

TEST(Run, ForceAboveTheDevicesMaximumNeverGetsOut) {
  scene::Description d = pressed_block(0.004);
  d.device->max_force_n = 0.05;
  Log log;
  const loop::RunResult result = run_with(d, log, 0.1);
  ASSERT_TRUE(result.status.ok());
  double requested = 0.0, sent = 0.0;
  for (const loop::TickRecord& tick : log.ticks) {
    requested = std::max(requested, tick.requested.force.norm());
    sent = std::max(sent, tick.device.force.norm());
  }
  EXPECT_GT(requested, 0.1);
  EXPECT_LE(sent, 0.05);
  EXPECT_GT(result.limited_ticks, 0);
}
#endif

}  // namespace
