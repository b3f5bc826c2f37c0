#include "loop/touch_reduction.h"

#include <gtest/gtest.h>

#include "loop/linearise.h"
#include "loop/small_scenes.h"
#include "loop/tool_side.h"
#include "palpate/contact/contact_force.h"
#include "palpate/core/counters.h"
#include "palpate/loop/run.h"
#ifdef PALPATE_HAS_TOOL
#include "palpate/tool/tool.h"

using namespace palpate;
using namespace palpate::small_scenes;

namespace {

constexpr double kPeriod = 0.01;

/// The block under the tool, its nodes on the way somewhere.
std::unique_ptr<loop::World> touching(scene::Description d, const std::string& linearisation,
                                      double error = 0.0) {
  d.exchange.linearisation = linearisation;
  d.exchange.linearisation_error = error;
  d.tool->tick_s = kPeriod;
  auto world = loop::assemble(d);
  loop::ToolSide& side = loop::ToolSide::of(*world);
  side.trajectory->append(0.0, side.tool->pose(), {});
  world->contact->refresh(world->state.view());
  VecX u = world->state.u();
  for (Eigen::Index i = 0; i < u.size(); ++i) u[i] += 1e-3 * std::sin(1.0 + 7.0 * static_cast<double>(i));
  VecX q = world->state.q();
  world->system.impose(world->state.layout(), 0.0, q.data(), u.data());
  world->state.u() = u;
  return world;
}

struct Linear {
  Vec6 F;
  Mat6 J, B;
  explicit Linear(const dynamics::LinearisedContact& r)
      : F(Eigen::Map<const Vec6>(r.F0.data())),
        J(Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(r.J.data())),
        B(Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(r.B.data())) {}
};

loop::ContactRecord record_of(loop::World& world) {
  long fallbacks = 0;
  const loop::ContactRecord record = loop::linearise_contact(world, 1, kPeriod, fallbacks);
  EXPECT_EQ(fallbacks, 0);
  return record;
}

/// One tick as long as the period.
Linear whole_tick(loop::World& world) {
  const loop::ContactRecord record = record_of(world);
  EXPECT_EQ(record.linear.source, dynamics::LinearisedContact::Source::kPoints);
  contact::TouchTicks ticks(world.description.contacts);
  ticks.adopt(record.touch);
  const loop::ToolSide& side = loop::ToolSide::of(world);
  return Linear(ticks.linearise(kPeriod, kPeriod, {side.known.pose, side.known.twist}));
}

void expect_same(const Linear& a, const Linear& b, double error) {
  EXPECT_LE((a.F - b.F).tail<3>().norm(), error * b.F.tail<3>().norm());
  const auto of_force = [](const Mat6& m) { return Mat3(m.bottomRightCorner<3, 3>()); };
  EXPECT_LE((of_force(a.J) - of_force(b.J)).norm(), error * of_force(b.J).norm());
  EXPECT_LE((of_force(a.B) - of_force(b.B)).norm(),
            error * (of_force(b.B).norm() + kPeriod * of_force(b.J).norm()));
}

// Galerkin's answer is exact where the exact one is in the span: one step over the period.
TEST(TouchReduction, OneTickOfAPeriodIsTheCondensedAnswer) {
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

TEST(TouchReduction, AFewIterationsAnswerToTheErrorAskedFor) {
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

// A coarse basis errs to one side: bodies are never softer than they are.
TEST(TouchReduction, ACrudeBasisIsTooStiffNeverTooSoft) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.004;
  const Linear factored = whole_tick(*touching(d, "points")), crude = whole_tick(*touching(d, "points", 0.9));
  EXPECT_LT(crude.J(5, 5), factored.J(5, 5) * (1.0 + 1e-6));
}

// A body all of whose nodes are held has points, and no mode to answer with.
TEST(TouchReduction, AHeldBodyHasPointsAlone) {
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

TEST(TouchReduction, NothingNearIsNoPoint) {
  const auto world = touching(pressed_block(-0.1), "points");
  EXPECT_EQ(record_of(*world).touch.points, 0);
}

}  // namespace
#endif
