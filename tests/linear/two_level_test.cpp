#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "linear/bent_beam.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace dynamics;

// Twice the squared Courant number costs block Jacobi 1.4 times the iterations; rigid clusters represent the
// long waves, so that the count hardly grows.
TEST(TwoLevel, StiffnessHardlyShowsInTheCount) {
  std::vector<long> two_level, single;
  for (const double E : {1e5, 1e7}) {
    BentBeam beam(24, E);
    BorderedMatrix A;
    VecX b, x;
    beam.at(0.7, 1e-2, A, b);
    for (const char* name : {"pcg-single", "pcg-two-level"}) {
      const auto solver = linear::make_linear_solver(name, {.linear_rtol = 1e-6});
      ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
      ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
      (std::string(name) == "pcg-single" ? single : two_level).push_back(solver->counters().iterations);
    }
  }
  EXPECT_GT(single[1], 3 * single[0]) << "a hundred times the stiffness";
  EXPECT_LT(two_level[1], 2 * two_level[0]);
}

TEST(TwoLevel, KeepsItsClustersWhileTheyServe) {
  BentBeam beam(16, 1e6);
  const auto solver = linear::make_linear_solver("pcg-two-level", {.linear_rtol = 1e-3});
  BorderedMatrix A;
  VecX b, x;
  for (int k = 0; k < 20; ++k) {
    beam.at(0.001 * k, 1e-2, A, b);
    ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
    ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  }
  EXPECT_EQ(solver->counters().refreshes, 1);
}

// Whole and zero-row-sum matrices are copied in different units, by powers of two: clusters of one serve the
// other.
TEST(TwoLevel, ServesWholeAndZeroRowSumMatricesInTurn) {
  BentBeam beam(16, 1e6);
  const double h = 1e-2;
  BorderedMatrix A;
  VecX b, x;
  const auto iterations_of = [&](LinearSolver& solver, bool whole) {
    const long before = solver.counters().iterations;
    if (whole) {
      beam.at(0.5, h, A, b);
      EXPECT_EQ(solver.factor(A), SolveStatus::kOk);
    } else {
      ZeroRowSumMatrix* room = mixed(solver).step_matrix(beam.pattern());
      if (!room) throw std::runtime_error("no room");
      beam.at(0.5, h, *room, b);
      EXPECT_EQ(mixed(solver).factor_step_matrix(), StepMatrixUse::kSolve);
    }
    MatX B = MatX::Zero(b.size(), 2), X;  // several columns start from zero
    B.col(0) = b;
    EXPECT_EQ(solver.solve(B, X), SolveStatus::kOk);
    x = X.col(0);
    return static_cast<double>(solver.counters().iterations - before);
  };
  for (const bool whole_first : {true, false}) {
    const auto solver = linear::make_linear_solver("pcg-two-level", {.linear_rtol = 1e-3});
    const double first = iterations_of(*solver, whole_first), second = iterations_of(*solver, !whole_first),
                 third = iterations_of(*solver, whole_first);
    EXPECT_LE(second, 1.2 * first + 2.0) << whole_first;
    EXPECT_LE(third, 1.2 * first + 2.0) << whole_first;
    EXPECT_EQ(solver->counters().refreshes, 1) << whole_first;
  }
}

}  // namespace
}  // namespace palpate
