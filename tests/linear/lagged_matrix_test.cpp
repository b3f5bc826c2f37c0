// Solves with a lagged matrix of an earlier step: as accurate as with the step's matrix, with a verified
// error.
#include <gtest/gtest.h>

#include <string>

#include "dynamics/energy_tolerance.h"
#include "linear/bent_beam.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace dynamics;

VecX direct_solution(const BorderedMatrix& A, const VecX& b) {
  const auto direct = linear::make_linear_solver("cholmod", {});
  VecX x;
  EXPECT_EQ(direct->factor(A), SolveStatus::kOk);
  EXPECT_EQ(direct->solve(b, x), SolveStatus::kOk);
  return x;
}

/// Returns a solver that has the zero-row-sum matrix of a beam bent by `angle`, and has solved with it for
/// the loads of an increasing bend.
std::unique_ptr<LinearSolver> solver_at(BentBeam& beam, const std::string& name, double angle, double h,
                                        double rtol) {
  auto solver = linear::make_linear_solver(name, {.linear_rtol = rtol});
  VecX b, x;
  for (int k = 3; k >= 0; --k) {
    ZeroRowSumMatrix* room = mixed(*solver).step_matrix(beam.pattern());
    if (!room) throw std::runtime_error("no room");
    beam.at(angle - 1e-3 * k, h, *room, b);
    EXPECT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kSolve);
    EXPECT_EQ(solver->solve(b, x), SolveStatus::kOk);
  }
  return solver;
}

TEST(LaggedMatrix, SolvesAsAccuratelyAsTheMatrixItself) {
  for (const std::string name : {"pcg-single", "pcg-two-level"})
    for (const double rtol : {1e-3, 1e-4, 1e-6}) {
      BentBeam beam(16, 1e5);
      const double h = 2e-3;
      const auto solver = solver_at(beam, name, 0.5, h, rtol);
      const long factors = solver->counters().factorisations;
      BorderedMatrix A;
      VecX b, x;
      for (int k = 1; k <= 5; ++k) {
        beam.at(0.5 + 1e-3 * k, h, A, b);
        Known left(A, b);
        if (mixed(*solver).solve_by_refinement(left, x) != SolveStatus::kOk) {
          EXPECT_GT(k, 1) << name << ", " << rtol << ": a matrix is tried at first";
          break;
        }
        const VecX exact = direct_solution(A, b);
        EXPECT_LE(energy_norm(A, x - exact), rtol * energy_norm(A, exact))
            << name << ", " << rtol << ", step " << k;
        EXPECT_GE(left.evaluated, k == 1 ? 2 : 1);
      }
      EXPECT_GE(solver->counters().lagged, rtol > 5e-4 ? 5 : 1) << name << ", " << rtol;
      EXPECT_EQ(solver->counters().factorisations, factors);
    }
}

// A matrix of another body with the same number of nodes must not produce a solution.
TEST(LaggedMatrix, SaysWhereItIsTooFar) {
  for (const std::string name : {"pcg-single", "pcg-two-level"}) {
    BentBeam beam(16, 1e6);
    const auto solver = solver_at(beam, name, 0.2, 1e-2, 1e-6);
    BorderedMatrix A;
    VecX b, x;
    beam.at(1.4, 1e-2, A, b);
    Known left(A, b);
    EXPECT_NE(mixed(*solver).solve_by_refinement(left, x), SolveStatus::kOk) << name;
    ZeroRowSumMatrix* room = mixed(*solver).step_matrix(beam.pattern());
    ASSERT_NE(room, nullptr);
    beam.at(1.4, 1e-2, *room, b);
    ASSERT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kSolve);
    ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
    const VecX exact = direct_solution(A, b);
    EXPECT_LE(energy_norm(A, x - exact), 1e-6 * energy_norm(A, exact))
        << name << ": its own matrix is taken up as if nothing had been";
  }
}

// An absolute tolerance saves iterations, and bounds the error.
TEST(LaggedMatrix, AcceptsAnAbsoluteTolerance) {
  for (const std::string name : {"pcg-single", "pcg-two-level", "auto"}) {
    long iterations[2] = {};
    for (const double allowed : {0.0, 1e-3}) {
      BentBeam beam(16, 1e5);
      const auto solver = solver_at(beam, name, 0.5, 2e-3, 1e-6);
      BorderedMatrix A;
      VecX b, x;
      beam.at(0.51, 2e-3, A, b);
      const VecX exact = direct_solution(A, b);
      const double size = energy_norm(A, exact);
      Known left(A, b);
      dynamic_cast<EnergyTolerance&>(*solver).allow_error(allowed * size);
      const long before = solver->counters().iterations;
      ASSERT_EQ(mixed(*solver).solve_by_refinement(left, x), SolveStatus::kOk) << name;
      iterations[allowed > 0.0] = solver->counters().iterations - before;
      EXPECT_LE(energy_norm(A, x - exact), std::max(1e-6, allowed) * size) << name;
    }
    EXPECT_LT(iterations[1], iterations[0]) << name;
  }
}

TEST(LaggedMatrix, NeedsAZeroRowSumMatrixAndASolution) {
  BentBeam beam(8, 1e5);
  BorderedMatrix A;
  VecX b, x;
  beam.at(0.3, 1e-3, A, b);
  Known left(A, b);
  const auto solver = linear::make_linear_solver("pcg-single", {.linear_rtol = 1e-4});
  EXPECT_NE(mixed(*solver).solve_by_refinement(left, x), SolveStatus::kOk);
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  EXPECT_NE(mixed(*solver).solve_by_refinement(left, x), SolveStatus::kOk);
  EXPECT_EQ(left.evaluated, 0);
}

/// Placed between a stepper and its solver: compares every solution of a step with a direct solution.
class EverySolve final : public LinearSolver, public MixedPrecisionSolver {
 public:
  EverySolve(std::unique_ptr<LinearSolver> solver, BentBeam& beam, double h)
      : solver_(std::move(solver)),
        mixed_(dynamic_cast<MixedPrecisionSolver*>(solver_.get())),
        beam_(beam),
        h_(h) {}
  std::string name() const override { return solver_->name(); }
  bool supports_unsymmetric() const override { return false; }
  SolveStatus factor(const BorderedMatrix& A) override { return solver_->factor(A); }
  ZeroRowSumMatrix* step_matrix(const BlockSparse& pattern) override {
    return mixed_ ? mixed_->step_matrix(pattern) : nullptr;
  }
  StepMatrixUse factor_step_matrix() override { return mixed_->factor_step_matrix(); }
  SolveStatus solve(const MatX& B, MatX& X) override { return solver_->solve(B, X); }
  SolveStatus solve(const VecX& b, VecX& x) override {
    const SolveStatus status = solver_->solve(b, x);
    if (status == SolveStatus::kOk) compare(b, x, worst_own);
    return status;
  }
  ZeroRowSumMatrix* lagged_matrix() override { return mixed_ ? mixed_->lagged_matrix() : nullptr; }
  void renew_points() override { mixed_->renew_points(); }
  std::optional<SolveStatus> solve_by_refinement(ResidualFunction& residual, VecX& x) override {
    if (!mixed_) return {};
    const std::optional<SolveStatus> status = mixed_->solve_by_refinement(residual, x);
    if (status != SolveStatus::kOk) return status;
    VecX b;
    residual.at(VecX::Zero(x.size()), b);
    compare(b, x, worst_lagged);
    return status;
  }
  const SolverCounters& counters() const override { return solver_->counters(); }
  double worst_own = 0.0, worst_lagged = 0.0;

 private:
  void compare(const VecX& b, const VecX& x, double& worst) {
    const double t1 = beam_.state.time() + h_;
    beam_.system.step_matrix(beam_.state.view(t1, beam_.state.q().data(), beam_.state.u().data()), 1.0, h_,
                             h_ * h_, A_);
    const VecX exact = direct_solution(A_, b);
    worst = std::max(worst, energy_norm(A_, x - exact) / energy_norm(A_, exact));
  }
  std::unique_ptr<LinearSolver> solver_;
  MixedPrecisionSolver* mixed_;  ///< null if the solver lacks the capability
  BentBeam& beam_;
  double h_;
  BorderedMatrix A_;
};

struct Swing {
  double worst_own = 0.0, worst_lagged = 0.0, moved = 0.0;
  long lagged = 0, steps = 0, checks = 0;
  VecX q;
};
/// Swings a beam; `blow` is a velocity that its end suddenly receives half way.
Swing swing(const std::string& name, double h, double rtol, int steps, double blow, int threads = 1,
            const BentBeamOptions& options = {}) {
  BentBeam beam(16, 1e5, 0, options);
  const IntegratorSpec spec{.name = "linearly-implicit-euler",
                            .step_s = h,
                            .linear_solver = name,
                            .linear_rtol = rtol,
                            .threads = threads};
  auto every = std::make_unique<EverySolve>(linear::make_linear_solver(name, spec), beam, h);
  EverySolve& seen = *every;
  const auto stepper = find(integrate::stepper_registry(), spec.name, "integrator")
                           .make(beam.system, beam.state, spec, std::move(every));
  for (int k = 0; k < steps; ++k) {
    if (k == steps / 2)
      for (Eigen::Index i = 0; i < beam.rest.size(); i += 3)
        if (beam.rest[i] > 0.3) beam.state.u()[i + 2] += blow;  // unknown to the stepper
    const StepResult r = stepper->advance_to(beam.state.time() + h);
    EXPECT_TRUE(r.ok()) << r.message;
  }
  const StepperCounters& c = stepper->counters();
  return {seen.worst_own,  seen.worst_lagged, (beam.state.q() - beam.rest).lpNorm<Eigen::Infinity>(),
          c.solver.lagged, c.steps,           c.solver.residual_checks,
          beam.state.q()};
}

TEST(LaggedMatrix, EveryStepOfASwingHasItsTolerance) {
  for (const std::string name : {"pcg-single", "pcg-two-level", "auto"})
    for (const auto& [h, rtol] :
         {std::pair{1e-3, 1e-3}, {1e-3, 1e-4}, {1e-3, 1e-6}, {4e-3, 1e-3}, {1e-2, 1e-3}}) {
      if (name == "auto" && rtol != 1e-4) continue;
      const int steps = static_cast<int>(std::lround(0.16 / h));
      const Swing s = swing(name, h, rtol, steps, 0.0);
      EXPECT_GT(s.moved, 0.05);
      EXPECT_LE(s.worst_lagged, rtol) << name << ", h = " << h;
      EXPECT_LE(s.worst_own, rtol) << name << ", h = " << h;
      if (h == 1e-3 && rtol == 1e-3) {
        EXPECT_GT(s.lagged, steps / 2) << name;
        EXPECT_LT(s.checks, 5 * s.lagged / 4) << name << ": most are known to be good without a check";
      }
    }
}

// The first steps after an impulse, which no history predicts.
TEST(LaggedMatrix, ABlowIsSeen) {
  for (const std::string name : {"pcg-single", "pcg-two-level"})
    for (const double blow : {0.1, 1.0, 10.0}) {
      const Swing s = swing(name, 1e-3, 1e-3, 120, blow);
      EXPECT_GT(s.lagged, 30) << name << ", " << blow;
      EXPECT_LE(s.worst_lagged, 1e-3) << name << ", " << blow;
    }
}

// Both kinds of damping, and a moving end, are included in the step's residual and in its matrix.
TEST(LaggedMatrix, DampedAndDrivenItIsTheSameMotion) {
  for (const BentBeamOptions& options :
       {BentBeamOptions{.stiffness_damping = 0.01},
        {.mass_damping = 20.0},
        {.stiffness_damping = 0.003, .mass_damping = 5.0, .shake_m = 0.01}}) {
    const Swing lagged = swing("pcg-single", 1e-3, 1e-3, 100, 0.0, 1, options),
                direct = swing("cholmod", 1e-3, 1e-3, 100, 0.0, 1, options);
    EXPECT_GT(lagged.lagged, 30);
    EXPECT_EQ(direct.lagged, 0);
    EXPECT_LE(lagged.worst_lagged, 1e-3);
    EXPECT_LT((lagged.q - direct.q).lpNorm<Eigen::Infinity>(), 1e-3 * direct.moved);
  }
}

TEST(LaggedMatrix, ThreadsDoNotChangeABit) {
  const Swing one = swing("pcg-two-level", 1e-3, 1e-3, 60, 0.0, 1),
              three = swing("pcg-two-level", 1e-3, 1e-3, 60, 0.0, 3);
  EXPECT_GT(one.lagged, 20);
  EXPECT_EQ(one.lagged, three.lagged);
  EXPECT_EQ(one.q, three.q);
}

// Tolerances for which the single-precision copy is too coarse: the steps of its matrix are corrected by it,
// and each is checked, as are steps with a lagged matrix.
TEST(LaggedMatrix, ARoundedMatrixKeepsTightTolerances) {
  for (const std::string name : {"pcg-single", "pcg-two-level"})
    for (const auto& [h, rtol] : {std::pair{1e-3, 1e-8}, {1e-3, 1e-10}, {1e-2, 1e-9}}) {
      const int steps = static_cast<int>(std::lround(0.08 / h));
      const Swing s = swing(name, h, rtol, steps, 1.0);
      EXPECT_LE(s.worst_lagged, rtol) << name << ", h = " << h;
      EXPECT_LE(s.worst_own, rtol) << name << ", h = " << h;
      EXPECT_GE(s.checks, 2 * (steps - 1))
          << name << ", h = " << h << ": the first step has nothing to begin with";
    }
}

// After a reinitialisation the stepper uses no earlier matrix.
TEST(LaggedMatrix, IsForgottenAtAReinitialisation) {
  BentBeam beam(16, 1e5);
  const auto stepper = integrate::make_stepper(beam.system, beam.state,
                                               {.name = "linearly-implicit-euler",
                                                .step_s = 1e-3,
                                                .linear_solver = "pcg-single",
                                                .linear_rtol = 1e-3});
  int kept_steps = 0;
  for (int k = 1; k <= 60; ++k) {
    const long factors = stepper->counters().solver.factorisations,
               lagged = stepper->counters().solver.lagged;
    if (k > 40) stepper->reinit(ReinitReason::kParametersChanged);
    ASSERT_TRUE(stepper->advance_to(1e-3 * k).ok());
    if (k > 40) { EXPECT_EQ(stepper->counters().solver.factorisations, factors + 1); }
    kept_steps += static_cast<int>(stepper->counters().solver.lagged - lagged);
  }
  EXPECT_GT(kept_steps, 10);
}

}  // namespace
}  // namespace palpate
