// Unsymmetric matrices by flexible GMRES, preconditioned by a solution with their symmetric part.
#include <gtest/gtest.h>

#include <cmath>

#include "linear/gmres.h"
#include "linear/unsymmetric_matrices.h"
#include "palpate/core/error.h"
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
  for (int i = 0; i < 2; ++i) {  // made anew, and once more with other values in the same pattern
    const MatX dense = A.to_dense();
    const BorderedMatrix& S = part.of(A);
    EXPECT_TRUE(S.symmetric);
    EXPECT_LT((S.to_dense() - 0.5 * (dense + dense.transpose())).norm(), 1e-15 * dense.norm());
    A.body.block(A.body.slot(3, 4))[2] += 7.0;
    A.touch();
  }
}

// The residual that it claims, at the rate of theory: with an exact S the spectrum of A S^-1 lies on 1 +- i
// |N|_S, so that each direction takes at least rho = |N|_S / (1 + sqrt(1 + |N|_S^2)), up to a constant: 2 in
// the norm of S^-1, and the root of its condition in that of the residual.
TEST(Gmres, ReachesTheResidualThatItClaimsAtTheRateOfTheory) {
  int checked = 0;
  for (const double mu : {0.1, 0.3, 1.0}) {
    const BorderedMatrix A = row_with_friction(60, 1.0, 2, 1.0, mu);
    const double skew = skew_norm(A), rho = skew / (1.0 + std::sqrt(1.0 + skew * skew));
    ASSERT_GT(skew, 0.02) << mu;
    const VecX b = VecX::LinSpaced(A.size(), -1.0, 3.0);
    for (const bool exact : {true, false})
      for (const double rtol : {1e-4, 1e-8, 1e-12}) {
        linear::Gmres solver(rtol, exact ? linear::make_linear_solver("cholmod")
                                         : linear::make_linear_solver("pcg-single", {.linear_rtol = 1e-2}));
        ASSERT_EQ(solver.factor(A), SolveStatus::kOk);
        VecX x, Ax;
        ASSERT_EQ(solver.solve(b, x), SolveStatus::kOk);
        A.multiply(x, Ax);
        EXPECT_LE((b - Ax).norm(), rtol * b.norm()) << mu;
        constexpr double kCondition = 8.0;  // of S: ground 1, springs 4, contact 1 and its friction
        const double rate = exact ? rho : std::max(rho, 0.05),  // two digits, in another norm
            most = std::ceil(std::log(0.5 * rtol / std::sqrt(kCondition)) / std::log(rate));
        EXPECT_LE(static_cast<double>(solver.directions()), most) << mu << ", " << rtol << ", " << exact;
        EXPECT_GE(solver.directions(), 2);
        EXPECT_EQ(solver.counters().solves, 1);
        ++checked;
      }
  }
  EXPECT_EQ(checked, 18);
}

// Contact that is stiffer than the nodes behind it by more than 4/mu^2: S = k [[1 + t, -mu/2], [-mu/2, t]] is
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
