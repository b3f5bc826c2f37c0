#include "palpate/loop/stepped_run.h"

#include <gtest/gtest.h>

#include "loop/small_scenes.h"

using namespace palpate;
using namespace palpate::small_scenes;

namespace {

class Ticks : public loop::Observer {
 public:
  void tick(const loop::TickRecord& tick) override { forces.push_back(tick.device.force); }
  std::vector<Vec3> forces;
};

/// A falling block, or, where tools are built in, a block pressed by a tool.
scene::Description moving_scene() {
#ifdef PALPATE_HAS_TOOL
  return pressed_block(0.002);
#else
  scene::Description d = held_block();
  d.gravity_m_s2 = Vec3(0, 0, -10);
  return d;
#endif
}

TEST(SteppedRun, AllPeriodsTogetherAreTheRunBitForBit) {
  const scene::Description d = moving_scene();
  const auto whole = loop::assemble(d), stepped = loop::assemble(d);
  const VecX start = whole->state.q();
  Ticks felt_whole, felt_stepped;
  loop::RunOptions options;
  options.observers = {&felt_whole};
  const loop::RunResult expected = loop::run(*whole, options);
  ASSERT_TRUE(expected.status.ok());

  options.observers = {&felt_stepped};
  loop::SteppedRun run(*stepped, options);
  EXPECT_EQ(run.duration(), d.duration_s);
  long periods = 0;
  for (double last = 0.0; run.next(); last = run.result().time, ++periods) {
    EXPECT_GT(run.result().time, last);
    EXPECT_EQ(stepped->state.time(), run.result().time);
  }
  EXPECT_EQ(periods, expected.periods);
  EXPECT_EQ(run.result().time, expected.time);
  EXPECT_FALSE(run.next()) << "once more, after the end";
  EXPECT_EQ(stepped->state.q(), whole->state.q());
  EXPECT_EQ(stepped->state.u(), whole->state.u());
  EXPECT_GT((whole->state.q() - start).norm(), 1e-5) << "something moved";
  EXPECT_EQ(felt_stepped.forces, felt_whole.forces);
  EXPECT_EQ(run.result().ticks, expected.ticks);
  EXPECT_EQ(run.result().counters.steps, expected.counters.steps);
  EXPECT_EQ(run.result().contact_queries, expected.contact_queries);
}

TEST(SteppedRun, AStopOrAFailureEndsIt) {
  std::atomic<bool> stop{true};
  const auto world = loop::assemble(held_block());
  loop::RunOptions options;
  options.stop = &stop;
  loop::SteppedRun stopped(*world, options);
  EXPECT_FALSE(stopped.next());
  EXPECT_TRUE(stopped.result().stopped);
  EXPECT_EQ(stopped.result().time, 0.0);

  scene::Description d = held_block();
  d.gravity_m_s2 = Vec3(0, 0, -10);
  d.integrator.name = "cvode-bdf";
  d.integrator.max_steps = 1;
  const auto stuck = loop::assemble(d);
  loop::SteppedRun failed(*stuck, {});
  EXPECT_FALSE(failed.next());
  EXPECT_FALSE(failed.result().status.ok());
  EXPECT_FALSE(failed.result().stopped);
}

}  // namespace
