// Bodies reduced to contact points and modes: how exactly they respond to the tool, and what their records
// contain.
#include "loop/coupling/model_reduction.h"

#include <gtest/gtest.h>

#include "core/counters.h"
#include "loop/small_scenes.h"
#include "loop/summary.h"
#include "palpate/loop/run.h"
#ifdef PALPATE_HAS_TOOL
#include "loop/reduced_ticks.h"

using namespace palpate;
using namespace palpate::reduced_ticks;
using namespace palpate::small_scenes;

namespace {

// Galerkin's solution is exact where the exact solution is in the span: one step over the period.
TEST(ModelReduction, OneTickOfAPeriodIsTheCondensedAnswer) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.005;  // several vertices press
  d.contacts[0].damping_pa_s_m = 2e4;
  const Linear condensed(record_of(*touching(d, "condensed")).linear);
  const auto world = touching(d, "points");
  const loop::ContactRecord record = record_of(*world);
  ASSERT_GT(record.touch.points, 3);
  ASSERT_GE(record.touch.modes, 4);
  expect_same(whole_tick(*world), condensed, 1e-7);
}

TEST(ModelReduction, AFewIterationsAnswerToTheErrorAskedFor) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.004;
  d.contacts[0].damping_pa_s_m = 2e4;
  const Linear factored = whole_tick(*touching(d, "points"));
  counters::reset();
  const auto world = touching(d, "points", 0.01);
  const Linear iterated = whole_tick(*world);
  EXPECT_GT(counters::snapshot()["loop.touch_iterations"], 0);
  EXPECT_EQ(counters::snapshot()["loop.touch_factored"], 0);
  expect_same(iterated, factored, 0.01);
}

// Includes every term that the iteration leaves to be computed: a moving support, a floor under the block,
// mass damping, and the inertia in a tick shorter than the period.
TEST(ModelReduction, IterationsKnowFloorSupportAndDamping) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.005;
  d.bodies[0].position_m.z() = 0.0097;  // 0.3 mm deep in the floor
  d.bodies[0].mass_damping_per_s = 200.0;
  d.contacts[0].damping_pa_s_m = 2e4;
  AttachmentSpec& side = d.bodies[0].attachments[0];
  side.box_min_m = Vec3(-1, -1, -1);
  side.box_max_m = Vec3(-0.0199, 1, 1);
  KeyframeSpec start, end;
  end.time_s = 1.0;
  end.position_m = Vec3(0.05, -0.02, 0.1);
  side.keyframes = {start, end};
  add_floor(d, d.contacts[0]);
  for (const double tick : {kPeriod, 0.1 * kPeriod}) {
    const Linear factored = tick_of(*touching(d, "points"), tick);
    counters::reset();
    const Linear iterated = tick_of(*touching(d, "points", 1e-4), tick);
    EXPECT_EQ(counters::snapshot()["loop.touch_factored"], 0);
    expect_same(iterated, factored, 0.01);
  }
}

// A coarse basis has a one-sided error: reduced bodies are never softer than the bodies.
TEST(ModelReduction, ACrudeBasisIsTooStiffNeverTooSoft) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.004;
  const Linear factored = whole_tick(*touching(d, "points")), crude = whole_tick(*touching(d, "points", 0.9));
  EXPECT_LT(crude.J(5, 5), factored.J(5, 5) * (1.0 + 1e-6));
}

// Error report of a run: the bound is at most the requested error, and zero if all solves were factored.
TEST(ModelReduction, ARunSaysHowExactlyBodiesAnswered) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.004;
  double largest = 0.0;
  for (const double requested : {0.3, 0.01, 0.0}) {
    d.exchange.linearisation_error = requested;
    const auto world = loop::assemble(d);
    ASSERT_TRUE(loop::run(*world, {}).status.ok());
    const std::vector<loop::AnswerError> all = loop::answer_errors_of(*world);
    ASSERT_EQ(all.size(), 1u);
    const loop::AnswerError& e = all[0];
    EXPECT_EQ(e.tool, "tool");
    EXPECT_EQ(e.requested, requested);
    EXPECT_GE(e.exchanges, 4);
    EXPECT_EQ(e.factored, requested > 0.0 ? 0 : e.exchanges);
    EXPECT_EQ(e.beyond, 0);
    EXPECT_LE(e.largest, requested);
    EXPECT_LE(e.mean, e.largest);
    if (requested == 0.01) { EXPECT_LT(e.largest, 0.2 * largest); }
    EXPECT_EQ(e.largest > 0.0, requested > 0.0);
    largest = e.largest;
  }
  const auto apart = loop::assemble(pressed_block(-0.05));
  ASSERT_TRUE(loop::run(*apart, {}).status.ok());
  EXPECT_TRUE(loop::answer_errors_of(*apart).empty());
}

/// Contact forces, tick by tick, of a tool that a stiff coupling presses down on the block over two long
/// periods, with the second record `ticks` late.
std::vector<double> forces_with_latency(int ticks) {
  scene::Description d = pressed_block(0.001);
  d.tool->coupling.stiffness_n_m = 1e5;
  d.tool->coupling.damping_n_s_m = 100.0;
  KeyframeSpec down = d.device->keyframes[0];
  down.time_s = 0.08;
  down.position_m.z() -= 0.004;
  d.device->keyframes.push_back(down);
  d.exchange.exchange_period_s = 0.05;
  d.duration_s = 0.1;
  d.exchange.latency_ticks = ticks;
  struct Keep : loop::Observer {
    void tick(const loop::TickRecord& tick) override { forces.push_back(tick.contact.force.z()); }
    std::vector<double> forces;
  } keep;
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.observers = {&keep};
  EXPECT_TRUE(loop::run(*world, options).status.ok());
  return keep.forces;
}

// A record of a past time is advanced to the tick that adopts it, along the tool's path since then: the block
// is then where a prompt record would place it.
TEST(ModelReduction, ALateRecordKnowsWhatTheToolHasDoneSince) {
  constexpr int kLate = 25;
  constexpr std::size_t kSecond = 50, kTaken = kSecond + kLate;
  const std::vector<double> prompt = forces_with_latency(0), late = forces_with_latency(kLate);
  ASSERT_EQ(prompt.size(), late.size());
  EXPECT_GT(late[kTaken - 1], 2.0 * prompt[kTaken - 1]) << "the record before says something else";
  for (std::size_t i = kTaken; i < prompt.size(); ++i) EXPECT_NEAR(late[i], prompt[i], 0.015 * prompt[i]);
}

// A body whose nodes are all held has points, and no mode to respond with.
TEST(ModelReduction, AHeldBodyHasPointsAlone) {
  for (const double error : {0.0, 0.1}) {
    scene::Description d = pressed_block(0.002);
    d.bodies[0].attachments[0].box_max_m = Vec3(1, 1, 1);
    const auto world = touching(d, "points", error);
    const loop::ContactRecord record = record_of(*world);
    EXPECT_GT(record.touch.points, 0);
    EXPECT_EQ(record.touch.modes, 0);
    EXPECT_GT(whole_tick(*world).F[5], 0.0);
  }
}

/// Displacement of each point due to a force on any other, held for a period: 3 points x 3 points.
MatX softness(const contact::ReducedContactModel& model) {
  constexpr int kMost = contact::ReducedContactModel::kMostModes;
  MatX modes(3 * model.points, kMost);
  for (int j = 0; j < model.points; ++j)
    modes.middleRows<3>(3 * j) = Eigen::Map<const Eigen::Matrix<double, 3, kMost>>(
        model.point[static_cast<std::size_t>(j)].modes.data());
  const VecX answer =
      (1.0 / (kPeriod * kPeriod) + Eigen::Map<const VecX>(model.stiffness.data(), kMost).array()).inverse();
  return modes * answer.asDiagonal() * modes.transpose();
}

// Two integrators leave a body without motion at rest to rounding, each differently: the record must not
// depend on the integrator.
TEST(ModelReduction, RoundingGivesNoDirection) {
  for (const double error : {0.0, 0.1}) {
    std::vector<MatX> seen;
    for (const double seed : {1.0, 2.0}) {
      scene::Description d = pressed_block(-1e-4);
      d.bodies[0].mesh.element_size_m = 0.005;
      d.exchange.linearisation = "points";
      d.exchange.linearisation_error = error;
      const auto world = loop::assemble(d);
      world->contact->refresh(world->state.view());
      VecX q = world->state.q();
      for (Eigen::Index i = 0; i < q.size(); ++i)
        q[i] += 1e-17 * std::sin(seed + 7.0 * static_cast<double>(i));
      world->state.q() = q;
      const loop::ContactRecord record = record_of(*world);
      ASSERT_GT(record.touch.points, 0);
      ASSERT_GE(record.touch.modes, 3);
      seen.push_back(softness(record.touch));
    }
    ASSERT_EQ(seen[0].rows(), seen[1].rows());
    // a basis of a few iterations has the responses to single precision
    EXPECT_LE((seen[0] - seen[1]).norm(), (error > 0.0 ? 1e-6 : 1e-12) * seen[0].norm());
  }
}

TEST(ModelReduction, NothingNearIsNoPoint) {
  const auto world = touching(pressed_block(-0.1), "points");
  EXPECT_EQ(record_of(*world).touch.points, 0);
}

// The element contributions of an exchange are reused by the step over the period that it begins, if there is
// such a step; other steps request nothing, and nothing is kept.
TEST(ModelReduction, TheStepTakesTheElementsOfItsExchange) {
  for (const bool linearised : {true, false}) {
    scene::Description d = pressed_block(1e-3);
    d.integrator.name = linearised ? "linearly-implicit-euler" : "backward-euler";
    d.integrator.linear_solver = "pcg-two-level";
    const auto world = loop::assemble(d);
    const long before = counters::counter("dynamics.kept_step_taken");
    const loop::RunResult result = loop::run(*world, {});
    ASSERT_TRUE(result.status.ok()) << result.status.message;
    EXPECT_EQ(counters::counter("dynamics.kept_step_taken") - before, linearised ? result.periods : 0);
    EXPECT_EQ(world->system.kept_step().versions.empty(), !linearised);
  }
}

}  // namespace
#endif
