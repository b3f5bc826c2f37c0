#include <gtest/gtest.h>

#include <string>

#include "contact/fixture.h"
#include "linear/bent_beam.h"
#include "malloc_count.h"
#include "palpate/integrate/integrators.h"

namespace palpate {
namespace {

using namespace dynamics;

/// A beam that two rotating rigid blocks press with springs and dampers beside their centres, one at its end
/// and one at its middle. The blocks also weigh, and their gyroscopic moment is part of the tangent.
struct PressedBeam : BentBeam {
  std::shared_ptr<contact::ContactForce> contact = std::make_shared<contact::ContactForce>();
  PressedBeam() : BentBeam(16, 1e5) {
    for (const double x : {0.5, 0.0}) press(Vec3(x, 0.0, 0.125));
    system.add(std::static_pointer_cast<ForceTerm>(contact));
    system.prepare(state.view());
    contact->refresh(state.view());
  }

 private:
  void press(const Vec3& place) {
    const Pose pose{quaternion_of(Vec3(0.1, 0.2, -0.3)), place + Vec3(0.02, 0.03, 0.05)};
    VecX q(7), u(6);
    q << pose.rotation.w(), pose.rotation.vec(), pose.translation;
    u << 1.0, -3.0, 2.0, 0.1, 0.0, -0.2;
    const int block = state.insert(rigid_block(place.x() > 0.0 ? "one" : "other", 0.05, 1.0), q, u);
    const Vec3 inertia(0.002, 0.003, 0.004);
    system.add(make_rigid_inertia(block, 0.5, inertia));
    system.add(make_gyroscopic(block, inertia, true));
    system.add(make_rigid_weight(block, 0.5, Vec3(0, 0, -9.81)));
    const int frame = contact->add_frame(contact::block_frame(block));
    std::vector<contact::ContactSample> samples;
    for (int node = 0; node < state.layout().node_count(); ++node)
      if ((rest.segment<3>(3 * node) - place).norm() < 0.1)
        samples.push_back(contact_tests::on_frame(contact_tests::node_point({node}, {1.0}), frame, pose,
                                                  Vec3(0.1, 0.2, -1.0), 0.02, 1.0, state));
    EXPECT_GT(samples.size(), 3u);
    ContactSpec law;
    law.stiffness_pa_m = 2e3;
    law.damping_pa_s_m = 20.0;
    contact->add_pair(std::make_unique<contact_tests::ListSource>(samples), law);
  }
};

// Steps assembled in one pass equal steps of the general assembly, to the solver's tolerance; no whole matrix
// is assembled.
TEST(LinearlyImplicitEuler, StepsTheSameInOnePass) {
  for (const std::string name : {"pcg-single", "pcg-two-level"}) {
    BentBeam fast(16, 1e5), direct(16, 1e5);
    const auto one_pass = integrate::make_stepper(
        fast.system, fast.state,
        {.name = "linearly-implicit-euler", .step_s = 2e-3, .linear_solver = name, .linear_rtol = 1e-6});
    const auto general = integrate::make_stepper(
        direct.system, direct.state,
        {.name = "linearly-implicit-euler", .step_s = 2e-3, .linear_solver = "cholmod"});
    for (int k = 1; k <= 20; ++k) {
      ASSERT_TRUE(one_pass->advance_to(2e-3 * k).ok());
      ASSERT_TRUE(general->advance_to(2e-3 * k).ok());
    }
    const VecX moved = direct.state.q() - direct.rest;
    EXPECT_GT(moved.norm(), 1e-3);
    EXPECT_LT((fast.state.q() - direct.state.q()).norm(), 1e-5 * moved.norm()) << name;
    const StepperCounters& c = one_pass->counters();
    EXPECT_EQ(c.tangent_evaluations + c.solver.lagged, 20);
    EXPECT_EQ(c.solver.factorisations, c.tangent_evaluations);
    EXPECT_GE(c.force_evaluations, 20);
    EXPECT_EQ(c.solver.solves, 20);
    EXPECT_EQ(c.solver.symbolic, 1);
    EXPECT_EQ(c.unconverged, 0);
  }
}

// prepare() performs one-time work ahead of the first step, and changes neither the state nor, apart
// from what a linear solver learned, the steps.
TEST(LinearlyImplicitEuler, PreparesItsFirstStep) {
  for (const std::string name : {"pcg-single", "pcg-two-level", "auto", "cholmod"}) {
    BentBeam prepared(16, 1e5), other(16, 1e5);
    const IntegratorSpec spec{
        .name = "linearly-implicit-euler", .step_s = 2e-3, .linear_solver = name, .linear_rtol = 1e-6};
    const auto ready = integrate::make_stepper(prepared.system, prepared.state, spec);
    const auto cold = integrate::make_stepper(other.system, other.state, spec);
    const VecX q = prepared.state.q(), u = prepared.state.u();
    ready->prepare(2e-3);
    EXPECT_EQ(prepared.state.q(), q);
    EXPECT_EQ(prepared.state.u(), u);
    EXPECT_EQ(prepared.state.time(), 0.0);
    EXPECT_EQ(ready->counters().steps, 0);
    const long analysed = ready->counters().solver.symbolic;
    EXPECT_EQ(analysed, name == "auto" ? 2 : 1) << name;  // one per candidate solver
    for (const auto& stepper : {ready.get(), cold.get()})
      for (int k = 1; k <= 2; ++k) ASSERT_TRUE(stepper->advance_to(2e-3 * k).ok());
    EXPECT_EQ(ready->counters().solver.symbolic, analysed) << name;
    EXPECT_EQ(ready->counters().steps, 2);
    const VecX moved = other.state.q() - other.rest;
    EXPECT_LT((prepared.state.q() - other.state.q()).norm(), 1e-5 * moved.norm()) << name;
  }
}

// Rigid blocks are eliminated: steps equal those of the whole matrix, whose rows of the blocks are no
// transpose of its columns.
TEST(LinearlyImplicitEuler, StepsTheSameWithRigidBlocks) {
  constexpr double kStep = 2e-3;
  for (const std::string name : {"pcg-single", "pcg-two-level", "auto"})
    for (const double rtol : {1e-4, 1e-11}) {
      PressedBeam fast, direct;
      const auto one_pass = integrate::make_stepper(
          fast.system, fast.state,
          {.name = "linearly-implicit-euler", .step_s = kStep, .linear_solver = name, .linear_rtol = rtol});
      const auto general = integrate::make_stepper(
          direct.system, direct.state,
          {.name = "linearly-implicit-euler", .step_s = kStep, .linear_solver = "umfpack"});
      const VecX start = direct.state.q();
      for (int k = 1; k <= 12; ++k) {
        ASSERT_TRUE(one_pass->advance_to(kStep * k).ok());
        ASSERT_TRUE(general->advance_to(kStep * k).ok());
        const VecX moved = direct.state.q() - start;
        EXPECT_LT((fast.state.q() - direct.state.q()).norm(), std::max(1e-9, rtol) * moved.norm())
            << name << ", " << rtol << ", step " << k;
      }
      EXPECT_GE(one_pass->counters().solver.residual_checks, 12);
      EXPECT_EQ(general->counters().solver.residual_checks, 0);
      if (rtol == 1e-4) { EXPECT_GT(one_pass->counters().solver.lagged, 2) << name; }
    }
}

// A contact query leaves the bodies' part of the matrix and the history of the steps as they are; a change of
// the state does not.
TEST(LinearlyImplicit, KeepsItsMatrixOverContactQueries) {
  constexpr double kStep = 1e-3;
  for (const std::string name : {"linearly-implicit-euler", "linearly-implicit-bdf2"}) {
    PressedBeam queried, other;
    const IntegratorSpec spec{
        .name = name, .step_s = kStep, .linear_solver = "pcg-single", .linear_rtol = 1e-3};
    const auto stepper = integrate::make_stepper(queried.system, queried.state, spec);
    const auto without = integrate::make_stepper(other.system, other.state, spec);
    const VecX start = other.state.q();
    for (int k = 1; k <= 16; ++k) {
      if (k > 8) {
        queried.contact->refresh(queried.state.view());
        stepper->reinit(ReinitReason::kContactRefreshed);
      }
      ASSERT_TRUE(stepper->advance_to(kStep * k).ok());
      ASSERT_TRUE(without->advance_to(kStep * k).ok());
    }
    const long matrices = stepper->counters().tangent_evaluations;
    EXPECT_LE(matrices, without->counters().tangent_evaluations) << name;
    EXPECT_LT(matrices, 12) << name;
    EXPECT_LT((queried.state.q() - other.state.q()).norm(), 1e-9 * (other.state.q() - start).norm()) << name;
    stepper->reinit(ReinitReason::kStateChanged);
    ASSERT_TRUE(stepper->advance_to(kStep * 17).ok());
    EXPECT_GT(stepper->counters().tangent_evaluations, matrices) << name;
  }
}

TEST(LinearlyImplicitEuler, AllocatesNothingOnceWarm) {
#if PALPATE_CAN_COUNT
  for (const std::string name : {"pcg-single", "pcg-two-level", "auto"}) {
    BentBeam beam(16, 1e5);
    const auto stepper = integrate::make_stepper(
        beam.system, beam.state,
        {.name = "linearly-implicit-euler", .step_s = 1e-3, .linear_solver = name, .linear_rtol = 1e-4});
    for (int k = 1; k <= 8; ++k) ASSERT_TRUE(stepper->advance_to(1e-3 * k).ok());
    const long warm = malloc_calls;
    for (int k = 9; k <= 16; ++k) ASSERT_TRUE(stepper->advance_to(1e-3 * k).ok());
    EXPECT_EQ(malloc_calls - warm, 0) << name;
    PressedBeam pressed;
    const auto together = integrate::make_stepper(
        pressed.system, pressed.state,
        {.name = "linearly-implicit-euler", .step_s = 1e-3, .linear_solver = name, .linear_rtol = 1e-4});
    for (int k = 1; k <= 8; ++k) ASSERT_TRUE(together->advance_to(1e-3 * k).ok());
    const long before = malloc_calls;
    for (int k = 9; k <= 16; ++k) ASSERT_TRUE(together->advance_to(1e-3 * k).ok());
    EXPECT_EQ(malloc_calls - before, 0) << name << ", with rigid blocks";
  }
#else
  GTEST_SKIP() << "a sanitizer owns malloc: nothing can be counted here";
#endif
}

}  // namespace
}  // namespace palpate
