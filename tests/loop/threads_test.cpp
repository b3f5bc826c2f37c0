#include <gtest/gtest.h>

#include "loop/small_scenes.h"
#include "palpate/core/workers.h"
#include "palpate/loop/run.h"

using namespace palpate;
using namespace palpate::small_scenes;

namespace {

/// About ten thousand elements, in several chunks, released from a state out of equilibrium.
scene::Description falling_block(const std::string& integrator, int threads) {
  scene::Description d = held_block();
  d.bodies[0].mesh.element_size_m = 0.0025;
  d.bodies[0].stiffness_damping_s = 1e-4;
  d.gravity_m_s2 = Vec3(0, 2, -9.81);
  d.integrator.name = integrator;
  d.integrator.threads = threads;
  d.integrator.step_s = integrator == "linearly-implicit-euler" ? 0.004 : 2e-5;
  if (integrator == "linearly-implicit-euler") d.integrator.linear_solver = "pcg-two-level";
  return d;
}

/// A second block above the first with its upper end held, moving down into it.
scene::Description touching_blocks(int threads) {
  scene::Description d = falling_block("linearly-implicit-euler", threads);
  d.integrator.linear_solver = "auto";
  d.bodies.push_back(d.bodies[0]);
  d.bodies[1].name = "upper";
  d.bodies[1].position_m.z() = 0.0295;
  d.bodies[1].attachments[0].box_min_m.z() = 0.0395 - 1e-6;
  d.bodies[1].attachments[0].box_max_m.z() = 0.0395 + 1e-6;
  ContactSpec contact;
  contact.first = "block";
  contact.second = "upper";
  contact.method = "distance";
  contact.stiffness_pa_m = 1e6;
  contact.friction = 0.3;
  d.contacts.push_back(contact);
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.004;
  return d;
}

struct Ran {
  VecX q, u;
  long by_second = 0;  ///< tasks of shared loops that ran on the second thread
  int threads = 0;     ///< threads available to loops during the run
};

class Watch : public loop::Observer {
 public:
  void period(loop::World&, double) override { threads = workers::count(); }
  int threads = 0;
};

Ran run(loop::World& world, double duration_s) {
  Watch watch;
  loop::RunOptions options;
  options.duration_s = duration_s;
  options.observers = {&watch};
  const long before = workers::tasks_of(1);
  EXPECT_TRUE(loop::run(world, options).status.ok());
  return {world.state.q(), world.state.u(), workers::tasks_of(1) - before, watch.threads};
}

class Threads : public testing::Test {
 protected:
  void TearDown() override { workers::set_count(1); }
};

// Without a linear solver: the elements' work is shared.
TEST_F(Threads, ReachTheElementsAndChangeNoBitOfTheResult) {
  const Ran one = run(*loop::assemble(falling_block("rk4", 1)), 0.004);
  const Ran two = run(*loop::assemble(falling_block("rk4", 2)), 0.004);
  EXPECT_EQ(one.threads, 1);
  EXPECT_EQ(one.by_second, 0);
  EXPECT_EQ(two.threads, 2);
  EXPECT_GT(two.by_second, 10) << "in 200 steps of several chunks each";
  EXPECT_GT((one.q - loop::assemble(falling_block("rk4", 1))->state.q()).norm(), 1e-6);
  EXPECT_TRUE((one.q.array() == two.q.array()).all());
  EXPECT_TRUE((one.u.array() == two.u.array()).all());
}

TEST_F(Threads, OfElementsAndOfALinearSolverTogetherChangeNoBitEither) {
  const Ran one = run(*loop::assemble(falling_block("linearly-implicit-euler", 1)), 0.02);
  const Ran two = run(*loop::assemble(falling_block("linearly-implicit-euler", 2)), 0.02);
  EXPECT_GT(two.by_second, 0);
  EXPECT_TRUE((one.q.array() == two.q.array()).all());
  EXPECT_TRUE((one.u.array() == two.u.array()).all());
}

TEST_F(Threads, OfTwoBodiesInContactChangeNoBitEither) {
  const auto world = loop::assemble(touching_blocks(1));
  const Ran one = run(*world, 0.02);
  long pressed = 0;
  for (const auto& s : world->contact->samples()) pressed += s.gap < 0.0;
  EXPECT_GT(pressed, 100);
  const Ran two = run(*loop::assemble(touching_blocks(2)), 0.02);
  EXPECT_GT(two.by_second, 0);
  EXPECT_TRUE((one.q.array() == two.q.array()).all());
  EXPECT_TRUE((one.u.array() == two.u.array()).all());
}

TEST_F(Threads, TwoWorldsOfAProcessKeepTheirOwnNumbers) {
  const auto two = loop::assemble(falling_block("rk4", 2));
  const auto one = loop::assemble(falling_block("rk4", 1));
  EXPECT_EQ(workers::count(), 1) << "the last one's, for who steps a World by hand";
  const Ran of_two = run(*two, 0.002), of_one = run(*one, 0.002);
  EXPECT_EQ(of_two.threads, 2);
  EXPECT_GT(of_two.by_second, 0);
  EXPECT_EQ(of_one.threads, 1);
  EXPECT_EQ(of_one.by_second, 0);
  EXPECT_TRUE((of_one.q.array() == of_two.q.array()).all());
}

}  // namespace
