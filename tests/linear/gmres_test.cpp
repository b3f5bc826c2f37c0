// Unsymmetric matrices by flexible GMRES, preconditioned by a solve with their symmetric part.
#include "linear/gmres.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "core/counters.h"
#include "linear/unsymmetric_matrices.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace dynamics;

TEST(SymmetricPart, IsTheMeanOfBothTriangles) {
  BorderedMatrix A = row_with_friction(12, 0.3, 2, 5.0, 0.4);
  A.right = MatX::Random(36, 2);
  A.bottom = MatX::Random(2, 36);
  A.corner = MatX::Random(2, 2);
  linear::SymmetricPart part;
  for (int i = 0; i < 2; ++i) {  // new, and again with other values in the same pattern
    const MatX dense = A.to_dense();
    const BorderedMatrix& S = part.of(A);
    EXPECT_TRUE(S.symmetric);
    EXPECT_LT((S.to_dense() - 0.5 * (dense + dense.transpose())).norm(), 1e-15 * dense.norm());
    A.body.block(A.body.slot(3, 4))[2] += 7.0;
    A.touch();
  }
}

double dense_energy_norm(const MatX& A, const VecX& x) { return std::sqrt(x.dot(A * x)); }

/// Number of directions from theory: 2 rho^k <= rtol, with rho the rate for an exact symmetric part.
double most_directions(double skew, double rtol) {
  return std::ceil(std::log(0.5 * rtol) / std::log(skew / (1.0 + std::sqrt(1.0 + skew * skew))));
}

// Number of directions and error equal the bounds of theory, without any constant.
TEST(Gmres, ConvergesAtTheRateOfTheoryOverAFactor) {
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
      const double skew = skew_norm(A);
      ASSERT_GT(skew, 0.02) << mu;
      const MatX dense = A.to_dense(), S = 0.5 * (dense + dense.transpose());
      const VecX b = VecX::LinSpaced(A.size(), -1.0, 3.0), exact = dense.partialPivLu().solve(b);
      for (const double rtol : {1e-2, 1e-5, 1e-8, 1e-12}) {
        const auto cholesky = linear::make_linear_solver("cholmod");
        linear::Gmres solver(rtol, *cholesky);
        ASSERT_EQ(solver.factor(A), SolveStatus::kOk);
        VecX x = b;
        ASSERT_EQ(solver.solve(x, x), SolveStatus::kOk);
        EXPECT_LE(dense_energy_norm(S, x - exact), rtol * (1.0 + skew) * dense_energy_norm(S, exact))
            << mu << " " << rtol;
        EXPECT_LE(static_cast<double>(solver.directions()), most_directions(skew, rtol)) << mu << " " << rtol;
        EXPECT_GE(solver.directions(), 2);
        // both together: one factorisation, one right-hand side
        SolverCounters sum = cholesky->counters();
        sum += solver.counters();
        EXPECT_EQ(sum.solves, 1);
        EXPECT_EQ(sum.factorisations, 1);
        ++checked;
      }
    }
  EXPECT_EQ(checked, 32);
}

// The symmetric part is solved to two digits: each direction gains at most two digits, and the error is the
// same.
TEST(Gmres, ConvergesOverAnInexactSymmetricPart) {
  int checked = 0;
  for (const double mu : {0.1, 0.3, 1.0}) {
    const BorderedMatrix A = row_with_friction(60, 1.0, 2, 1.0, mu);
    const double skew = skew_norm(A);
    const MatX dense = A.to_dense(), S = 0.5 * (dense + dense.transpose());
    const VecX b = VecX::LinSpaced(A.size(), -1.0, 3.0), exact = dense.partialPivLu().solve(b);
    for (const double rtol : {1e-4, 1e-8, 1e-12}) {
      linear::Gmres solver(rtol, linear::make_linear_solver("pcg-single", {.linear_rtol = 1e-2}));
      ASSERT_EQ(solver.factor(A), SolveStatus::kOk);
      VecX x;
      ASSERT_EQ(solver.solve(b, x), SolveStatus::kOk);
      constexpr double kNorm = 1.01;  // inner tolerance, in the norm of the stopping criterion
      constexpr double kInner =
          0.1003;  // rho = 0.05: inner digits, and basis vectors orthogonal to that accuracy
      EXPECT_LE(dense_energy_norm(S, x - exact), kNorm * rtol * (1.0 + skew) * dense_energy_norm(S, exact))
          << mu;
      EXPECT_LE(static_cast<double>(solver.directions()), most_directions(std::max(skew, kInner), rtol))
          << mu << ", " << rtol;
      EXPECT_EQ(solver.counters().solves, 1);
      ++checked;
    }
  }
  EXPECT_EQ(checked, 9);
}

TEST(Gmres, SolvesASymmetricMatrixByItsFactorAlone) {
  BorderedMatrix A = row_with_friction(60, 0.1, 2, 0.5, 0.0);
  const VecX b = VecX::LinSpaced(180, -1.0, 3.0);
  const auto cholesky = linear::make_linear_solver("cholmod");
  linear::Gmres solver(1e-13, *cholesky);
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

// A symmetric body does not make the matrix symmetric: its border counts.
TEST(Gmres, SeesABorderThatIsNotSymmetric) {
  for (const bool in_corner : {false, true}) {
    BorderedMatrix A = row_with_friction(20, 1.0, 2, 1.0, 0.0);
    A.right = MatX::Zero(60, 2);
    A.bottom = MatX::Zero(2, 60);
    A.corner = 3.0 * MatX::Identity(2, 2);
    (in_corner ? A.corner(0, 1) : A.bottom(0, 7)) = 0.4;
    A.touch();
    const auto cholesky = linear::make_linear_solver("cholmod");
    linear::Gmres solver(1e-13, *cholesky);
    const VecX b = VecX::LinSpaced(62, -1.0, 3.0);
    VecX x, Ax;
    ASSERT_EQ(solver.factor(A), SolveStatus::kOk);
    ASSERT_EQ(solver.solve(b, x), SolveStatus::kOk);
    A.multiply(x, Ax);
    EXPECT_LE((Ax - b).norm(), 1e-12 * b.norm()) << in_corner;
  }
}

// Below a tolerance of 1e-10 the residual is computed from the solution, which takes one more product.
TEST(Gmres, ComputesATightResidual) {
  const BorderedMatrix A = row_with_friction(60, 1.0, 2, 1.0, 0.3);
  const VecX b = VecX::LinSpaced(180, -1.0, 3.0);
  const auto products = [&](double rtol) {
    const auto cholesky = linear::make_linear_solver("cholmod");
    linear::Gmres solver(rtol, *cholesky);
    VecX x;
    EXPECT_EQ(solver.factor(A), SolveStatus::kOk);
    EXPECT_EQ(solver.solve(b, x), SolveStatus::kOk);
    return solver.counters().iterations;
  };
  EXPECT_EQ(products(0.99e-10), products(1.01e-10) + 1);
}

TEST(Gmres, ReportsWhatItCannotSolve) {
  const auto cholesky = linear::make_linear_solver("cholmod");
  linear::Gmres solver(1e-8, *cholesky);
  EXPECT_EQ(solver.factor(row_with_friction(20, 1.0, 3, 1e4, 0.8)), SolveStatus::kIndefinite);
  const BorderedMatrix spinning = spinning_nodes(200, 20.0);  // rho = 0.95
  ASSERT_EQ(solver.factor(spinning), SolveStatus::kOk);
  VecX x;
  EXPECT_EQ(solver.solve(VecX(VecX::Ones(600)), x), SolveStatus::kNotConverged);
  BorderedMatrix broken = row_with_friction(20, 1.0, 3, 1.0, 0.3);
  broken.body.block(0)[1] = std::nan("");
  EXPECT_EQ(solver.factor(broken), SolveStatus::kSingular);
}

// An unchanged matrix is not factored again, unless the symmetric solver had another matrix in between.
TEST(Gmres, KeepsTheFactorOfAnUnchangedMatrix) {
  BorderedMatrix A = row_with_friction(20, 1.0, 2, 1.0, 0.3), other = row_with_friction(20, 2.0, 2, 1.0, 0.0);
  other.symmetric = true;
  const auto cholesky = linear::make_linear_solver("cholmod");
  linear::Gmres solver(1e-12, *cholesky);
  const VecX b = VecX::LinSpaced(60, -1.0, 3.0);
  const auto expect_solved = [&](long factorisations) {
    VecX x, Ax;
    ASSERT_EQ(solver.factor(A), SolveStatus::kOk);
    ASSERT_EQ(solver.solve(b, x), SolveStatus::kOk);
    A.multiply(x, Ax);
    EXPECT_LE((Ax - b).norm(), 1e-11 * b.norm());
    EXPECT_EQ(cholesky->counters().factorisations, factorisations);
  };
  expect_solved(1);
  expect_solved(1);
  ASSERT_EQ(cholesky->factor(other), SolveStatus::kOk);
  expect_solved(3);
  A.body.block(A.body.slot(3, 3))[1] += 0.1;
  A.touch();
  expect_solved(4);
}

// LU is the last resort: used for the two difficult matrices, never for one that the iteration solves.
TEST(Gmres, PrecedesLu) {
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
    BorderedMatrix bordered = spinning;
    add_border(bordered, 6, 400.0);
    solve(bordered);  // with a direct solver the border's columns do not converge
    EXPECT_EQ(lus, before + 1) << name;
  }
}

// Contact stiffer than the nodes behind it by more than 4/mu^2: S = k [[1 + t, -mu/2], [-mu/2, t]] is
// indefinite for t (1 + t) < mu^2/4, though A is not singular.
TEST(Gmres, SaysThatASymmetricPartIsIndefinite) {
  constexpr double kFriction = 0.8;
  const auto status = [&](double stiffness) {
    const BorderedMatrix A = row_with_friction(20, 1.0, 3, stiffness, kFriction);
    const auto solver = linear::make_linear_solver("gmres");
    SolveStatus out = solver->factor(A);
    VecX x;
    if (out == SolveStatus::kOk) out = solver->solve(VecX(VecX::LinSpaced(A.size(), -1.0, 3.0)), x);
    return out;
  };
  EXPECT_EQ(status(2.0), SolveStatus::kOk);
  EXPECT_EQ(status(1e4), SolveStatus::kIndefinite);
}

TEST(Gmres, IsWhatAutoTakesForAnUnsymmetricMatrix) {
  const BorderedMatrix A = row_with_friction(60, 1.0, 2, 1.0, 0.3);
  BorderedMatrix symmetric = row_with_friction(60, 1.0, 2, 1.0, 0.0);
  symmetric.symmetric = true;
  const auto solver = linear::make_linear_solver("auto", {.linear_rtol = 1e-10}),
             gmres = linear::make_linear_solver("gmres", {.linear_rtol = 1e-10});
  const VecX b = VecX::LinSpaced(A.size(), -1.0, 3.0);
  const BorderedMatrix* const given[] = {&symmetric, &A, &symmetric, &A};
  for (const BorderedMatrix* matrix : given) {
    ASSERT_EQ(solver->factor(*matrix), SolveStatus::kOk);
    VecX x, Ax, y;
    ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
    matrix->multiply(x, Ax);
    EXPECT_LE((b - Ax).norm(), 1e-8 * b.norm());
    if (matrix->symmetric) continue;
    ASSERT_EQ(gmres->factor(*matrix), SolveStatus::kOk);
    ASSERT_EQ(gmres->solve(b, y), SolveStatus::kOk);
    EXPECT_LT((x - y).norm(), 1e-9 * y.norm());
  }
}

TEST(Gmres, AnswersZeroByZero) {
  const BorderedMatrix A = row_with_friction(8, 1.0, 2, 1.0, 0.3);
  const auto solver = linear::make_linear_solver("gmres");
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  VecX x = VecX::Ones(A.size());
  ASSERT_EQ(solver->solve(VecX(VecX::Zero(A.size())), x), SolveStatus::kOk);
  EXPECT_EQ(x, VecX(VecX::Zero(A.size())));
}

}  // namespace
}  // namespace palpate
