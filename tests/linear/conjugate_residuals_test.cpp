// Unsymmetric matrices by conjugate residuals over a Cholesky factor of the symmetric part.
#include "linear/conjugate_residuals.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "linear/friction_row.h"
#include "palpate/core/counters.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace dynamics;

double energy_norm(const MatX& A, const VecX& x) { return std::sqrt(x.dot(A * x)); }

// S = 1 and N of nodes by themselves, v -> c_i axis x v: |N|_S is the largest c_i, and each is another
// eigenvalue.
BorderedMatrix spinning_nodes(int nodes, double largest) {
  BorderedMatrix A = row_with_friction(nodes, 0.0, 1, 0.0, 0.0);
  A.body.set_zero();
  for (int i = 0; i < nodes; ++i) {
    Mat3 block = Mat3::Identity();
    block(0, 1) = largest * (i + 1) / nodes;
    block(1, 0) = -block(0, 1);
    A.body.add(A.body.slot(i, i), block);
  }
  A.touch();
  return A;
}

// The number of steps that theory allows, 2 rho^k <= rtol, and the error that it promises, with no constant
// in either.
TEST(ConjugateResiduals, TakeNoMoreStepsThanTheSkewPartIsWorth) {
  int checked = 0;
  for (const double mu : {0.1, 0.3, 1.0, 1.5})
    for (const int border : {0, 2}) {
      BorderedMatrix A = row_with_friction(60, 1.0, 2, 1.0, mu);
      A.right = MatX::Zero(180, border);
      A.bottom = MatX::Zero(border, 180);
      A.corner = 3.0 * MatX::Identity(border, border);
      if (border > 0) {  // unsymmetric as well
        A.right(7, 0) = 0.3;
        A.bottom(0, 7) = -0.4;
        A.bottom(1, 90) = 0.5;
        A.corner(0, 1) = 0.8;
      }
      A.touch();
      const double skew = skew_norm(A), rho = skew / (1.0 + std::sqrt(1.0 + skew * skew));
      ASSERT_GT(skew, 0.02) << mu;
      const MatX dense = A.to_dense(), S = 0.5 * (dense + dense.transpose());
      const VecX b = VecX::LinSpaced(A.size(), -1.0, 3.0), exact = dense.partialPivLu().solve(b);
      for (const double rtol : {1e-2, 1e-5, 1e-8, 1e-12}) {
        const auto cholesky = linear::make_linear_solver("cholmod");
        linear::ConjugateResiduals solver(rtol, *cholesky);
        ASSERT_EQ(solver.factor(A), SolveStatus::kOk);
        VecX x = b;
        ASSERT_EQ(solver.solve(x, x), SolveStatus::kOk);
        EXPECT_LE(energy_norm(S, x - exact), rtol * (1.0 + skew) * energy_norm(S, exact))
            << mu << " " << rtol;
        const double most = std::ceil(std::log(0.5 * rtol) / std::log(rho));
        const int check = rtol < 1e-10 ? 1 : 0;
        EXPECT_LE(static_cast<double>(solver.counters().iterations), most + check) << mu << " " << rtol;
        EXPECT_GE(solver.counters().iterations, 2);
        // of both together: one factor, one right-hand side
        SolverCounters sum = cholesky->counters();
        sum += solver.counters();
        EXPECT_EQ(sum.solves, 1);
        EXPECT_EQ(sum.factorisations, 1);
        ++checked;
      }
    }
  EXPECT_EQ(checked, 32);
}

TEST(ConjugateResiduals, SolveASymmetricMatrixByItsFactorAlone) {
  BorderedMatrix A = row_with_friction(60, 0.1, 2, 0.5, 0.0);
  const VecX b = VecX::LinSpaced(180, -1.0, 3.0);
  const auto cholesky = linear::make_linear_solver("cholmod");
  linear::ConjugateResiduals solver(1e-8, *cholesky);
  for (const double skew : {0.0, 1e-16, 1e-9}) {  // the second one is rounding
    A.body.block(A.body.slot(7, 7))[1] += skew;
    A.touch();
    ASSERT_EQ(solver.factor(A), SolveStatus::kOk);
    VecX x, Ax;
    const long before = solver.counters().iterations;
    ASSERT_EQ(solver.solve(b, x), SolveStatus::kOk);
    A.multiply(x, Ax);
    EXPECT_LE((Ax - b).norm(), 1e-12 * b.norm());
    EXPECT_EQ(solver.counters().iterations > before, skew == 1e-9) << skew;
  }
  VecX x;
  ASSERT_EQ(solver.solve(VecX(VecX::Zero(180)), x), SolveStatus::kOk);
  EXPECT_EQ(x, VecX(VecX::Zero(180)));
}

TEST(ConjugateResiduals, SayWhatTheyCannotSolve) {
  const auto cholesky = linear::make_linear_solver("cholmod");
  linear::ConjugateResiduals solver(1e-8, *cholesky);
  EXPECT_EQ(solver.factor(row_with_friction(20, 1.0, 3, 1e4, 0.8)), SolveStatus::kIndefinite);
  const BorderedMatrix spinning = spinning_nodes(200, 20.0);  // rho = 0.95
  ASSERT_EQ(solver.factor(spinning), SolveStatus::kOk);
  VecX x;
  EXPECT_EQ(solver.solve(VecX(VecX::Ones(600)), x), SolveStatus::kNotConverged);
  BorderedMatrix broken = row_with_friction(20, 1.0, 3, 1.0, 0.3);
  broken.body.block(0)[1] = std::nan("");
  EXPECT_EQ(solver.factor(broken), SolveStatus::kSingular);
}

// Against a dense solution: rows of a tool that are no transpose of its columns, over a body that is
// symmetric and over one with friction; no body, no border.
TEST(BorderElimination, AgreesWithDense) {
  int checked = 0;
  for (const int border : {0, 6, 13})
    for (const double mu : {0.0, 0.3}) {
      BorderedMatrix A = row_with_friction(40, 1.0, 2, 1.0, mu);
      A.right = MatX::Random(120, border);
      A.bottom = MatX::Random(border, 120);
      A.corner = 30.0 * MatX::Identity(border, border) + MatX::Random(border, border);
      A.touch();
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

// The complement needs an inverse, not a Cholesky factor.
TEST(BorderElimination, TakesAnIndefiniteComplementAndSeesASingularOne) {
  BorderedMatrix A = row_with_friction(40, 1.0, 2, 1.0, 0.0);
  A.right = MatX::Random(120, 6);
  A.bottom = MatX::Random(6, 120);
  A.corner = -30.0 * MatX::Identity(6, 6);
  A.touch();
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

// LU is the last resort: made for the two matrices above, never for one that the iteration solves with.
TEST(ConjugateResiduals, StandBeforeLu) {
  const BorderedMatrix mild = row_with_friction(60, 1.0, 2, 1.0, 0.3),
                       indefinite = row_with_friction(60, 1.0, 3, 1e4, 0.8),
                       spinning = spinning_nodes(60, 20.0);
  for (const char* name : {"cholmod", "pcg", "pcg-single"}) {
    const auto robust = integrate::make_robust_linear_solver(name);
    const auto solve = [&](const BorderedMatrix& A) {
      ASSERT_EQ(robust->factor(A), SolveStatus::kOk);
      VecX x = VecX::LinSpaced(A.size(), -1.0, 3.0);
      const VecX b = x;
      ASSERT_EQ(robust->solve(x, x), SolveStatus::kOk);
      VecX Ax;
      A.multiply(x, Ax);
      EXPECT_LE((Ax - b).norm(), 1e-7 * b.norm()) << name;
    };
    const auto& lus = counters::counter("integrate.solver.umfpack");
    const long before = lus;
    solve(mild);
    EXPECT_EQ(lus, before) << name;
    solve(indefinite);
    EXPECT_EQ(lus, before + 1) << name;
    solve(mild);
    const long factors = robust->counters().factorisations;
    solve(spinning);
    EXPECT_GT(robust->counters().factorisations, factors + 1) << name << ": the iteration's, and LU's";
    EXPECT_EQ(lus, before + 1) << name << ": made once";
  }
}

}  // namespace
}  // namespace palpate
