// Settings of integrators: linear solvers of the user, refused values, and limits that are kept.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "integrate/steppers.h"

namespace palpate {
namespace {

using namespace fakes;

/// A user-defined LinearSolver: dense, with counters.
struct DenseSolver final : LinearSolver {
  Eigen::PartialPivLU<MatX> lu;
  SolverCounters count;
  std::string name() const override { return "dense"; }
  bool supports_unsymmetric() const override { return true; }
  SolveStatus factor(const BorderedMatrix& A) override {
    lu.compute(A.to_dense());
    ++count.factorisations;
    return SolveStatus::kOk;
  }
  SolveStatus solve(const MatX& B, MatX& X) override { return X = lu.solve(B), SolveStatus::kOk; }
  SolveStatus solve(const VecX& b, VecX& x) override {
    return x = lu.solve(b), ++count.solves, SolveStatus::kOk;
  }
  const SolverCounters& counters() const override { return count; }
};

TEST_P(Steppers, TakeAForeignLinearSolver) {
  Chain chain, same;
  chain.start_in_mode(0.1);
  same.start_in_mode(0.1);
  const auto& entry = find(integrate::stepper_registry(), spec().name, "integrator");
  const auto stepper = entry.make(chain.system, chain.state, spec(), std::make_unique<DenseSolver>());
  ASSERT_TRUE(stepper->advance_to(0.3).ok());
  // a hundredth of the tolerance
  EXPECT_LT((chain.state.q() - run(same.system, same.state, spec(), 0.3)).norm(), 1e-8);
  EXPECT_EQ(stepper->counters().solver.solves == 0, is_explicit(GetParam()));
}

template <class Change>
void expect_refused(const IntegratorSpec& good, Change change, const std::string& message) {
  Chain chain;
  IntegratorSpec s = good;
  change(s);
  try {
    integrate::make_stepper(chain.system, chain.state, s);
    FAIL() << message;
  } catch (const Error& e) { EXPECT_NE(std::string(e.what()).find(message), std::string::npos) << e.what(); }
}

TEST_P(Steppers, RefuseBadSettings) {
  using S = IntegratorSpec;
  expect_refused(
      spec(), [](S& s) { s.max_steps = 0; }, "max_steps = 0 must be at least 1");
  expect_refused(
      spec(), [](S& s) { s.linear_solver = "pardiso"; }, "unknown linear solver \"pardiso\"");
  if (steps_are_fixed(GetParam())) {
    expect_refused(
        spec(), [](S& s) { s.step_s = 0.0; }, "step_s = 0 must be positive");
    expect_refused(
        spec(), [](S& s) { s.step_s = -1e-3; }, "step_s = -0.001 must be positive");
    expect_refused(
        spec(), [](S& s) { s.step_s = std::nan(""); }, "step_s = nan must be positive");
    return;
  }
  expect_refused(
      spec(), [](S& s) { s.rtol = 0.0; }, "rtol = 0 must lie in (0, 0.1]; 1e-3 is usual");
  expect_refused(
      spec(), [](S& s) { s.rtol = std::nan(""); }, "rtol = nan must lie in (0, 0.1]; 1e-3 is usual");
  expect_refused(
      spec(), [](S& s) { s.rtol = 0.5; }, "rtol = 0.5 must lie in (0, 0.1]; 1e-3 is usual");
  expect_refused(
      spec(), [](S& s) { s.atol_q = 0.0; }, "atol_q = 0 must be positive");
  expect_refused(
      spec(), [](S& s) { s.atol_u = -1.0; }, "atol_u = -1 must be positive");
  const int highest = mode_traits(GetParam()).order;
  expect_refused(
      spec(), [](S& s) { s.max_order = 13; }, fmt::format("max_order = 13 must lie in [0, {}]", highest));
  if (mode_traits(GetParam()).control == StepControl::kAdaptive)
    expect_refused(
        spec(), [](S& s) { s.fixed_step = true; }, "fixed_step");
}

TEST(StepperRegistry, NamesTheNearest) {
  expect_refused(
      {}, [](IntegratorSpec& s) { s.name = "cvode-bdg"; },
      "unknown integrator \"cvode-bdg\" (did you mean \"cvode-bdf\"?)");
}

TEST(LinearlyImplicitEuler, FallsBackToLuOnAnIndefiniteMatrix) {
  Chain chain(0.0, -100.0);  // unstable: 1 + h^2 K has negative eigenvalues at h = 1
  IntegratorSpec s{.name = "linearly-implicit-euler", .step_s = 1.0};
  const auto stepper = integrate::make_stepper(chain.system, chain.state, s);
  ASSERT_TRUE(stepper->advance_to(2.0).ok());
  EXPECT_EQ(stepper->counters().indefinite, 2);
}

TEST(CvodeBdf, CapsItsOrder) {
  for (const int cap : {1, 2, 3}) {
    Chain chain;
    chain.start_in_mode(0.1);
    IntegratorSpec s{.name = "cvode-bdf", .rtol = 1e-6, .max_order = cap};
    const auto stepper = integrate::make_stepper(chain.system, chain.state, s);
    int highest = 0;
    for (int i = 1; i <= 20; ++i) highest = std::max(highest, stepper->advance_to(0.05 * i).order);
    EXPECT_EQ(highest, cap);
  }
}

TEST(CvodeBdf, FactorsSeldom) {
  Chain chain;
  chain.start_in_mode(0.1);
  const auto stepper =
      integrate::make_stepper(chain.system, chain.state, {.name = "cvode-bdf", .rtol = 1e-6});
  ASSERT_TRUE(stepper->advance_to(5.0).ok());
  EXPECT_LT(4 * stepper->counters().solver.factorisations, stepper->counters().steps);
}

}  // namespace
}  // namespace palpate
