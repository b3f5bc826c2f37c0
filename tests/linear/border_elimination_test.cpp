// A dense border eliminated by its Schur complement, over any solver of the body.
#include "linear/border_elimination.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "linear/unsymmetric_matrices.h"
#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace dynamics;

// Against a dense solution: a tool whose rows are no transpose of its columns, over a symmetric body and over
// one with friction; also without a body and without a border.
TEST(BorderElimination, AgreesWithDense) {
  int checked = 0;
  for (const int border : {0, 6, 13})
    for (const double mu : {0.0, 0.3}) {
      BorderedMatrix A = row_with_friction(40, 1.0, 2, 1.0, mu);
      add_border(A, border, 30.0);
      const auto cholesky = linear::make_linear_solver("cholmod");
      const auto solver = linear::make_unsymmetric_solver(*cholesky, {.linear_rtol = 1e-13});
      ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
      const Eigen::PartialPivLU<MatX> dense(A.to_dense());
      const MatX B = MatX::Random(A.size(), 3);
      MatX X = B;
      ASSERT_EQ(solver->solve(X, X), SolveStatus::kOk);
      EXPECT_LT((X - dense.solve(B)).norm(), 1e-11 * X.norm()) << border << ", " << mu;
      VecX b = B.col(1), x;
      ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
      EXPECT_LT((x - dense.solve(b)).norm(), 1e-11 * x.norm()) << border << ", " << mu;
      SolverCounters sum = cholesky->counters();
      sum += solver->counters();
      EXPECT_EQ(sum.solves, 4) << border << ", " << mu;
      EXPECT_EQ(sum.factorisations, 1);
      EXPECT_EQ(sum.iterations > 0, mu > 0.0) << "a symmetric body needs its factor alone";
      ++checked;
    }
  EXPECT_EQ(checked, 6);
}

// The complement needs an inverse, rather than a Cholesky factor.
TEST(BorderElimination, TakesAnIndefiniteComplementAndSeesASingularOne) {
  BorderedMatrix A = row_with_friction(40, 1.0, 2, 1.0, 0.0);
  add_border(A, 6, -300.0);
  const auto cholesky = linear::make_linear_solver("cholmod");
  const auto solver = linear::make_unsymmetric_solver(*cholesky, {});
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  VecX x;
  const VecX b = VecX::Ones(A.size());
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  EXPECT_LT((A.to_dense() * x - b).norm(), 1e-11 * b.norm());
  A.corner.row(2).setZero();
  A.bottom.row(2).setZero();
  A.touch();
  EXPECT_EQ(solver->factor(A), SolveStatus::kSingular);
}

// The border's columns are solved once per matrix; changed values in the border alone count as another
// matrix.
TEST(BorderElimination, KeepsTheComplementOfAnUnchangedMatrix) {
  BorderedMatrix A = row_with_friction(20, 1.0, 2, 1.0, 0.3), other = row_with_friction(20, 2.0, 2, 1.0, 0.0);
  other.symmetric = true;
  add_border(A, 6, 30.0);
  const auto cholesky = linear::make_linear_solver("cholmod");
  const auto solver = linear::make_unsymmetric_solver(*cholesky, {.linear_rtol = 1e-12});
  const VecX b = VecX::LinSpaced(A.size(), -1.0, 3.0);
  long before = 0;
  const auto expect_solved = [&](long factorisations, bool columns) {
    VecX x, Ax;
    before = solver->counters().iterations;
    ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
    EXPECT_EQ(solver->counters().iterations > before, columns);
    ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
    A.multiply(x, Ax);
    EXPECT_LE((Ax - b).norm(), 1e-10 * b.norm());
    EXPECT_EQ(cholesky->counters().factorisations, factorisations);
  };
  expect_solved(1, true);
  expect_solved(1, false);
  ASSERT_EQ(cholesky->factor(other), SolveStatus::kOk);
  expect_solved(3, false);
  A.bottom(2, 7) += 1.0;
  A.touch();
  expect_solved(4, true);
}

TEST(BorderElimination, SaysWhatItsColumnsMeet) {
  const auto cholesky = linear::make_linear_solver("cholmod");
  const auto solver = linear::make_unsymmetric_solver(*cholesky, {});
  BorderedMatrix spinning = spinning_nodes(200, 20.0);
  add_border(spinning, 6, 400.0);
  EXPECT_EQ(solver->factor(spinning), SolveStatus::kNotConverged);
  BorderedMatrix indefinite = row_with_friction(20, 1.0, 3, 1e4, 0.8);
  add_border(indefinite, 6, 400.0);
  EXPECT_EQ(solver->factor(indefinite), SolveStatus::kIndefinite);
  BorderedMatrix broken = row_with_friction(20, 1.0, 3, 1.0, 0.3);
  add_border(broken, 6, 400.0);
  broken.bottom(1, 1) = std::nan("");
  EXPECT_EQ(solver->factor(broken), SolveStatus::kSingular);
}

}  // namespace
}  // namespace palpate
