#include <gtest/gtest.h>

#include <string>

#include "linear/bent_beam.h"
#include "malloc_count.h"
#include "palpate/integrate/integrators.h"

namespace palpate {
namespace {

using namespace dynamics;

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
  }
#else
  GTEST_SKIP() << "a sanitizer owns malloc: nothing can be counted here";
#endif
}

}  // namespace
}  // namespace palpate
