// Newton's corrections by an iterative linear solver: as accurate as Newton's method requires, and no more.
#include <gtest/gtest.h>

#include "integrate/condensed_newton.h"
#include "integrate/error_weights.h"
#include "integrate/tolerance_systems.h"
#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace fakes;

/// Corrections of a swinging bar, and their cost.
struct Corrections {
  std::unique_ptr<Small> bar = swinging_bar(8, 3);
  VecX w, d;
  long iterations = 0;

  /// @param error  permitted error in the norm of the weights of rtol 1e-3; < 0: not specified
  Corrections(const char* solver, double error) {
    const auto stepper =
        integrate::make_stepper(bar->system, bar->state, {.name = "cvode-bdf", .rtol = 1e-4});
    EXPECT_TRUE(stepper->advance_to(0.1).ok());
    integrate::CondensedNewton newton(bar->system, linear::make_linear_solver(solver), {});
    StepperCounters counters;
    newton.evaluate(bar->state.view(), counters);
    const Layout& l = bar->state.layout();
    const Eigen::Index n = l.u_size;
    EXPECT_EQ(newton.factor(2e-3), SolveStatus::kOk);
    w.resize(2 * n);
    integrate::error_weights(l, {.rtol = 1e-3}, bar->system.driven_mask(), bar->state.u().data(), w.data());
    if (error >= 0.0) newton.limit_error(l, w.data(), error);
    d.resize(2 * n);
    for (int k = 0; k < 3; ++k) {  // the first solve has no information on the spectrum
      const VecX r = 1e-3 * VecX::LinSpaced(2 * n, -1.0, 1.0 + k).array().sin().matrix();
      const long before = newton.solver().counters().iterations;
      EXPECT_EQ(newton.solve(l, bar->state.q().data(), r.data(), r.data() + n, d.data(), d.data() + n),
                SolveStatus::kOk);
      iterations = newton.solver().counters().iterations - before;
    }
  }
  double size(const VecX& e) const {
    return std::sqrt(w.cwiseProduct(e).squaredNorm() / static_cast<double>(w.size()));
  }
};

TEST(LinearTolerance, BoundsTheErrorOfACorrection) {
  const Corrections exact("cholmod", -1.0);
  for (const char* solver : {"pcg-single", "pcg-two-level", "auto"}) {
    const Corrections tight(solver, -1.0);
    EXPECT_LT(exact.size(tight.d - exact.d), 1e-6 * exact.size(exact.d)) << solver;
    long before = tight.iterations;
    for (const double share : {1e-4, 1e-2}) {
      const double error = share * exact.size(exact.d);
      const Corrections limited(solver, error);
      EXPECT_LE(exact.size(limited.d - exact.d), error) << solver << ", " << share;
      EXPECT_GT(exact.size(limited.d - exact.d), 1e-4 * error) << solver << ": digits nobody asked for";
      EXPECT_LT(limited.iterations, before) << solver << ", " << share;
      before = limited.iterations;
    }
  }
}

// The step sequence of backward differences is sensitive: changing rtol by 3 % changes the error by a
// factor of two to three either way, also with a direct solver. The geometric mean over forty tolerances is
// stable.
TEST(LinearTolerance, LeavesTheErrorOfARunAsItIs) {
  const auto mean_error = [](const char* solver) {
    const auto made = swinging_bar();
    const auto at_end = [](const IntegratorSpec& spec) {
      auto bar = swinging_bar();
      const auto stepper = integrate::make_stepper(bar->system, bar->state, spec);
      EXPECT_TRUE(stepper->advance_to(0.15).ok());
      VecX y(bar->state.q().size() + bar->state.u().size());
      y << bar->state.q(), bar->state.u();
      return y;
    };
    const VecX reference = at_end({.name = "ark-dirk-esdirk547", .rtol = 1e-10});
    double sum = 0.0;
    int count = 0;
    for (double rtol = 1e-3; count < 40; rtol *= 0.9, ++count) {
      VecX w(reference.size());
      integrate::error_weights(made->state.layout(), {.rtol = rtol}, made->system.driven_mask(),
                               reference.data() + made->state.q().size(), w.data());
      const VecX e = at_end({.name = "ida", .rtol = rtol, .linear_solver = solver}) - reference;
      sum += std::log(w.cwiseProduct(e).squaredNorm());
    }
    return std::exp(0.5 * sum / count);
  };
  const double direct = mean_error("cholmod");
  EXPECT_NEAR(mean_error("pcg-single") / direct, 1.0, 0.3);
  EXPECT_NEAR(mean_error("auto") / direct, 1.0, 0.3);
}

}  // namespace
}  // namespace palpate
