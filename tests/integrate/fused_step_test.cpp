#include <gtest/gtest.h>

#include <string>

#include "linear/bent_beam.h"
#include "malloc_count.h"
#include "palpate/integrate/integrators.h"

namespace palpate {
namespace {

using namespace dynamics;

// Steps in one pass are the steps of the general way, to the solver's tolerance; and no whole matrix was made
// on the way.
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
