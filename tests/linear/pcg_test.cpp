#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <tuple>

#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace dynamics;

/// A cantilever of springs: nodes in a row with the first one held; the condition number is of the order of
/// the number of nodes squared.
BorderedMatrix row_of_springs(int nodes, double mass, int border = 0) {
  PatternBuilder pattern(nodes);
  for (int i = 0; i + 1 < nodes; ++i) pattern.add_pair(i, i + 1);
  BorderedMatrix A;
  A.body = pattern.build();
  A.body.add(A.body.slot(0, 0), Mat3::Identity());
  for (int i = 0; i < nodes; ++i) A.body.add(A.body.slot(i, i), mass * Mat3::Identity());
  for (int i = 0; i + 1 < nodes; ++i)
    for (const auto& [a, b, sign] :
         {std::tuple{i, i, 1.0}, {i + 1, i + 1, 1.0}, {i, i + 1, -1.0}, {i + 1, i, -1.0}})
      A.body.add(A.body.slot(a, b), sign * Mat3::Identity());
  A.right = MatX::Zero(3 * nodes, border);
  A.bottom = MatX::Zero(border, 3 * nodes);
  A.corner = MatX::Zero(border, border);
  A.touch();
  return A;
}

TEST(Pcg, ReachesTheResidualThatItClaims) {
  const BorderedMatrix A = row_of_springs(500, 0.05);
  const VecX b = VecX::LinSpaced(A.size(), -1.0, 3.0);
  long before = 0;
  for (const double rtol : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
    const auto solver = linear::make_linear_solver("pcg", {.linear_rtol = rtol});
    ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
    VecX x, Ax;
    ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
    A.multiply(x, Ax);
    EXPECT_LE((b - Ax).norm(), rtol * b.norm());
    EXPECT_GT(solver->counters().iterations, before) << "a tighter tolerance costs more";
    before = solver->counters().iterations;
  }
}

TEST(Pcg, StartsFromTheLastSolutionScaled) {
  const BorderedMatrix A = row_of_springs(500, 0.05);
  const auto solver = linear::make_linear_solver("pcg");
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  const VecX b = VecX::LinSpaced(A.size(), -1.0, 3.0);
  VecX x, y;
  const auto iterations = [&](const VecX& rhs) {
    const long before = solver->counters().iterations;
    EXPECT_EQ(solver->solve(rhs, y), SolveStatus::kOk);
    return solver->counters().iterations - before;
  };
  const long cold = iterations(b);
  x = y;
  EXPECT_GT(cold, 50);
  EXPECT_LE(iterations(-7.0 * b), 8)
      << "the same direction needs only its scale, and what the tolerance left";
  EXPECT_LT((y + 7.0 * x).norm(), 1e-5 * y.norm());
  iterations(b);
  EXPECT_LT(iterations(b + 1e-4 * VecX::Ones(b.size())), 3 * cold / 4) << "half of the digits are there";
}

TEST(Pcg, AnswersZeroByZeroAndWithoutWork) {
  const BorderedMatrix A = row_of_springs(20, 0.1);
  const auto solver = linear::make_linear_solver("pcg");
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  VecX x = VecX::Ones(60);
  ASSERT_EQ(solver->solve(VecX(VecX::Zero(60)), x), SolveStatus::kOk);
  EXPECT_EQ(x, VecX(VecX::Zero(60)));
  EXPECT_EQ(solver->counters().iterations, 0);
}

// The diagonal blocks are positive definite, the matrix is not: 1 - 2 cos of the longest wave is negative.
TEST(Pcg, FindsNegativeCurvatureWhileItSolves) {
  const BorderedMatrix A = row_of_springs(50, -0.01);
  const auto solver = linear::make_linear_solver("pcg");
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  VecX x = VecX::Ones(150);
  const VecX b = x;
  EXPECT_EQ(solver->solve(b, x), SolveStatus::kIndefinite);
  const auto robust = integrate::make_robust_linear_solver("pcg");
  ASSERT_EQ(robust->factor(A), SolveStatus::kOk);
  ASSERT_EQ(robust->solve(x = b, x), SolveStatus::kOk);
  VecX Ax;
  A.multiply(x, Ax);
  EXPECT_LT((Ax - b).norm(), 1e-10 * b.norm()) << "LU, in place, of the right-hand side as it was";
}

TEST(Pcg, GivesUpAnIterationThatDoesNotEnd) {
  const BorderedMatrix A = row_of_springs(4000, 0.0);  // 4,000 iterations propagate a force from end to end
  const auto solver = linear::make_linear_solver("pcg");
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  VecX x;
  EXPECT_EQ(solver->solve(VecX(VecX::Unit(A.size(), A.size() - 1)), x), SolveStatus::kNotConverged);
  EXPECT_LE(solver->counters().iterations, 1001);
  const auto robust = integrate::make_robust_linear_solver("pcg");
  ASSERT_EQ(robust->factor(A), SolveStatus::kOk);
  ASSERT_EQ(robust->solve(VecX(VecX::Unit(A.size(), A.size() - 1)), x), SolveStatus::kOk);
  EXPECT_NEAR(x[A.size() - 1], 4000.0, 1e-6) << "springs in series";
}

/// A rigid tool with six directions in contact with `touched` nodes, each by a spring k along a random
/// direction.
BorderedMatrix touched_by_a_tool(double k, int touched) {
  BorderedMatrix A = row_of_springs(100, 0.01, 6);
  A.corner = 0.1 * MatX::Identity(6, 6);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  for (int i = 0; i < touched; ++i) {
    const Vec3 n = Vec3::NullaryExpr([&] { return value(random); }).normalized(),
               arm = Vec3::NullaryExpr([&] { return value(random); });
    Vec6 along;
    along << arm.cross(n), n;
    const int node = 99 - 2 * i;
    A.body.add(A.body.slot(node, node), k * n * n.transpose());
    A.right.middleRows<3>(3 * node) -= k * n * along.transpose();
    A.corner += k * along * along.transpose();
  }
  A.bottom = A.right.transpose();
  A.touch();
  return A;
}

// The preconditioner's coarse space contains the six common motions of nodes and tool: six orders of
// magnitude in stiffness do not affect the iteration count.
TEST(Pcg, IsNotRuinedByAStiffTool) {
  std::vector<long> iterations;
  for (const double k : {1.0, 1e2, 1e4, 1e6}) {
    const BorderedMatrix A = touched_by_a_tool(k, 20);
    const auto solver = linear::make_linear_solver("pcg", {.linear_rtol = 1e-6});
    ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
    const VecX b = VecX::LinSpaced(A.size(), -1.0, 3.0);
    VecX x, Ax;
    ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
    A.multiply(x, Ax);
    EXPECT_LE((b - Ax).norm(), 1e-6 * b.norm());
    iterations.push_back(solver->counters().iterations);
  }
  for (const long n : iterations)
    EXPECT_LT(2 * n, 3 * iterations.front()) << testing::PrintToString(iterations);
}

TEST(Pcg, RefusesAToleranceOutOfRange) {
  for (const double bad : {0.0, -1e-8, 0.5, std::nan("")})
    EXPECT_THROW(linear::make_linear_solver("pcg", {.linear_rtol = bad}), Error) << bad;
}

TEST(Pcg, ChecksThatItsMatrixStands) {
  BorderedMatrix A = row_of_springs(10, 0.1);
  const auto solver = linear::make_linear_solver("pcg");
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  A.touch();
  VecX x;
  EXPECT_THROW(solver->solve(VecX(VecX::Ones(30)), x), InternalError);
}

}  // namespace
}  // namespace palpate
