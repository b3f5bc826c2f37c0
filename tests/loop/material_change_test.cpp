// Young's modulus changed during a run: effective from the next step on.
#include <gtest/gtest.h>

#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "palpate/integrate/integrators.h"
#include "palpate/loop/run.h"
#include "palpate/loop/world.h"

using namespace palpate;
using namespace palpate::small_scenes;

namespace {

constexpr double kBefore = 1e4, kAfter = 3e4;

/// The held block under its weight, in which it is not in equilibrium.
scene::Description sagging(const std::string& integrator) {
  scene::Description d = held_block();
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  d.bodies[0].youngs_modulus_pa = kBefore;
  d.integrator.name = integrator;
  d.integrator.step_s = 0.002;
  d.integrator.rtol = 1e-7;
  return d;
}

}  // namespace

// A one-step method depends on the state alone, and cholmod on the matrix alone: after the change the run is
// bitwise equal to one from that state with the new modulus.
TEST(MaterialChange, CountsFromTheNextStepOn) {
  for (const char* name : {"linearly-implicit-euler", "implicit-midpoint", "newmark"}) {
    scene::Description d = sagging(name);
    d.integrator.linear_solver = "cholmod";
    const auto changed = loop::assemble(d);
    loop::RunOptions first;
    first.duration_s = 0.02;
    ASSERT_TRUE(loop::run(*changed, first).status.ok());
    d.bodies[0].youngs_modulus_pa = kAfter;
    const auto fresh = loop::assemble(d);
    fresh->state.q() = changed->state.q();
    fresh->state.u() = changed->state.u();
    fresh->state.set_time(changed->state.time());
    fresh->stepper->reinit(dynamics::ReinitReason::kStateChanged);
    changed->set_youngs_modulus(changed->bodies[0], kAfter);
    ASSERT_TRUE(changed->stepper->advance_to(0.022).ok() && fresh->stepper->advance_to(0.022).ok());
    EXPECT_EQ(changed->state.q(), fresh->state.q()) << name;
    EXPECT_EQ(changed->state.u(), fresh->state.u()) << name;
  }
}

// A multistep method discards its history: every method reaches the same final state.
TEST(MaterialChange, OfASceneActsInTheRunWhateverTheIntegrator) {
  VecX reference;
  for (const char* name : {"ark-erk-5", "cvode-bdf", "ida", "ark-dirk-kvaerno745", "cvode-adams"}) {
    scene::Description d = sagging(name);
    d.duration_s = 0.05;
    d.bodies[0].changes = {{0.013, kAfter, {}}, {0.031, 0.5 * kAfter, {}}};
    const auto world = loop::assemble(d);
    const loop::RunResult result = loop::run(*world, {});
    ASSERT_TRUE(result.status.ok()) << name << ": " << result.status.message;
    EXPECT_DOUBLE_EQ(world->bodies[0].term->materials()[0].youngs_modulus, 0.5 * kAfter);
    const VecX end = world->state.q();
    if (reference.size() == 0) {
      reference = end;
      d.bodies[0].changes.clear();
      const auto without = loop::assemble(d);
      ASSERT_TRUE(loop::run(*without, {}).status.ok());
      EXPECT_GT((without->state.q() - end).norm(), 1e-3 * end.norm()) << "the changes matter";
      continue;
    }
    EXPECT_LT((end - reference).norm(), 2e-6 * reference.norm()) << name;
  }
}

TEST(MaterialChange, TakesTheNodalDilatationAlong) {
  scene::Description d = sagging("linearly-implicit-euler");
  d.bodies[0].volumetric = Volumetric::kNodal;
  d.bodies[0].poissons_ratio = 0.49;
  const auto changed = loop::assemble(d);
  d.bodies[0].youngs_modulus_pa = kAfter;
  const auto fresh = loop::assemble(d);
  changed->set_youngs_modulus(changed->bodies[0], kAfter);
  ASSERT_TRUE(loop::run(*changed, {}).status.ok() && loop::run(*fresh, {}).status.ok());
  EXPECT_EQ(changed->state.q(), fresh->state.q());
}

TEST(MaterialChange, RefusesWhatIsNoModulus) {
  const auto world = loop::assemble(sagging("linearly-implicit-euler"));
  EXPECT_THROW(world->set_youngs_modulus(world->bodies[0], -1.0), Error);
  EXPECT_DOUBLE_EQ(world->bodies[0].term->materials()[0].youngs_modulus, kBefore);
}

// The force on the hand follows the modulus under a tool that keeps its position.
#ifdef PALPATE_HAS_TOOL
TEST(MaterialChange, IsFeltByTheHand) {
  scene::Description d = pressed_block(0.003);
  d.duration_s = 0.6;
  d.bodies[0].changes = {{0.3, 4.0 * d.bodies[0].youngs_modulus_pa, {}}};
  struct Feel : loop::Observer {
    double before = 0.0, after = 0.0;
    void period(loop::World&, double) override {}
    void tick(const loop::TickRecord& t) override { (t.time < 0.3 ? before : after) = t.requested.force.z(); }
  } feel;
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.observers.push_back(&feel);
  ASSERT_TRUE(loop::run(*world, options).status.ok());
  EXPECT_GT(feel.before, 0.0);
  EXPECT_GT(feel.after, 1.3 * feel.before);
}
#endif
