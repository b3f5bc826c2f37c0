#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <tuple>

#include "integrate/registry_test_name.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace dynamics;

enum class Kind { kSpd, kUnsymmetric, kIndefinite };

/// Random bordered matrix with a dominant diagonal: positive definite; symmetric indefinite, with the
/// signs of every third node and of the corner reversed; or unsymmetric, with independent values in the
/// two triangles.
BorderedMatrix random_matrix(int nodes, int border, Kind kind, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::uniform_int_distribution<int> node(0, std::max(0, nodes - 1));
  PatternBuilder pattern(nodes);
  for (int i = 0; i < 4 * nodes; ++i) pattern.add_pair(node(random), node(random));
  BorderedMatrix A;
  A.body = pattern.build();
  A.symmetric = kind != Kind::kUnsymmetric;
  const double corner_sign = kind == Kind::kIndefinite ? -1.0 : 1.0;
  for (int i = 0; i < nodes; ++i)
    for (int s = A.body.row_start()[static_cast<std::size_t>(i)];
         s < A.body.row_start()[static_cast<std::size_t>(i) + 1]; ++s) {
      const int j = A.body.columns()[static_cast<std::size_t>(s)];
      const Mat3 m = Mat3::NullaryExpr([&] { return value(random); });
      if (i == j)
        A.body.add(s, (kind == Kind::kIndefinite && i % 3 == 0 ? -60.0 : 60.0) * Mat3::Identity() +
                          (A.symmetric ? Mat3(m + m.transpose()) : m));
      else if (!A.symmetric)
        A.body.add(s, m);
      else if (i < j) {
        A.body.add(s, m);
        A.body.add(A.body.slot(j, i), m.transpose());
      }
    }
  const auto draw = [&] { return value(random); };
  A.right = MatX::NullaryExpr(3 * nodes, border, draw);
  A.bottom = A.symmetric ? MatX(A.right.transpose()) : MatX::NullaryExpr(border, 3 * nodes, draw);
  const MatX c = MatX::NullaryExpr(border, border, draw);
  A.corner = corner_sign * (3.0 * nodes + 60.0) * MatX::Identity(border, border) + c + c.transpose();
  A.touch();
  return A;
}

class LinearSolvers : public testing::TestWithParam<std::string> {
 protected:
  /// An iterative solver's tolerance is set such that it must agree like a direct one.
  std::unique_ptr<LinearSolver> solver = linear::make_linear_solver(GetParam(), {.linear_rtol = 1e-14});
  std::vector<Kind> kinds() const {
    std::vector out{Kind::kSpd};
    if (solver->supports_indefinite()) out.push_back(Kind::kIndefinite);
    if (solver->supports_unsymmetric()) out.push_back(Kind::kUnsymmetric);
    return out;
  }
};

std::vector<std::string> solver_names() { return names(linear::linear_solver_registry()); }
INSTANTIATE_TEST_SUITE_P(Registry, LinearSolvers, testing::ValuesIn(solver_names()), registry_test_name);

/// Pivoting solvers: they accept any invertible matrix, and detect a singular one.
class PivotingSolvers : public LinearSolvers {};
std::vector<std::string> pivoting_names() {
  std::vector<std::string> out = solver_names();
  std::erase_if(out, [](const std::string& name) {
    return !linear::make_linear_solver(name, {})->supports_indefinite();
  });
  return out;
}
INSTANTIATE_TEST_SUITE_P(Registry, PivotingSolvers, testing::ValuesIn(pivoting_names()), registry_test_name);

TEST_P(LinearSolvers, AgreeWithDenseAnyBorderManyRightHandSides) {
  int checked = 0;
  for (const Kind kind : kinds())
    for (const int nodes : {0, 1, 30})
      for (const int border : {0, 6, 40}) {
        if (nodes + border == 0) continue;
        const BorderedMatrix A = random_matrix(nodes, border, kind, 7);
        ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
        const Eigen::PartialPivLU<MatX> dense(A.to_dense());
        for (const int count : {1, 5}) {
          const MatX B = MatX::Random(A.size(), count);
          MatX X = B;
          ASSERT_EQ(solver->solve(X, X), SolveStatus::kOk);  // in place
          EXPECT_LT((X - dense.solve(B)).norm(), 1e-12 * X.norm()) << nodes << " nodes, border " << border;
        }
        VecX b = VecX::Ones(A.size()), x;
        ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
        EXPECT_LT((x - dense.solve(b)).norm(), 1e-12 * x.norm());
        ++checked;
      }
  EXPECT_EQ(checked, 8 * static_cast<int>(kinds().size()));
}

TEST_P(LinearSolvers, DoNoWorkTwice) {
  BorderedMatrix A = random_matrix(30, 6, kinds().back(), 3);
  for (int i = 0; i < 3; ++i) ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  EXPECT_EQ(solver->counters().symbolic, 1);
  EXPECT_EQ(solver->counters().factorisations, 1);
  A.body.add(A.body.slot(4, 4), Mat3::Identity());
  A.touch();
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  EXPECT_EQ(solver->counters().symbolic, 1) << "new values keep the analysis";
  EXPECT_EQ(solver->counters().factorisations, 2);
  A = random_matrix(30, 6, kinds().back(), 4);
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  EXPECT_EQ(solver->counters().symbolic, 2) << "a new pattern needs a new one";
  MatX X;
  ASSERT_EQ(solver->solve(MatX::Ones(A.size(), 7), X), SolveStatus::kOk);
  EXPECT_EQ(solver->counters().solves, 7);
}

TEST_P(LinearSolvers, SameBodyPatternNewBorderKeepsTheAnalysis) {
  BorderedMatrix A = random_matrix(30, 6, Kind::kSpd, 3);
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  A.right = MatX::Zero(90, 2);
  A.bottom = MatX::Zero(2, 90);
  A.corner = MatX::Identity(2, 2);
  A.touch();
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  EXPECT_EQ(solver->counters().symbolic, 1);
  VecX x;
  ASSERT_EQ(solver->solve(VecX(A.to_dense() * VecX::Ones(92)), x), SolveStatus::kOk);
  EXPECT_LT((x - VecX::Ones(92)).norm(), 1e-12);
}

TEST_P(LinearSolvers, ReportWhatHasNoFactor) {
  BorderedMatrix A = random_matrix(10, 6, Kind::kSpd, 5);
  const BorderedMatrix good = A;
  A.body.add(A.body.slot(3, 3), -200.0 * Mat3::Identity());
  A.touch();
  EXPECT_EQ(solver->factor(A), solver->supports_indefinite() ? SolveStatus::kOk : SolveStatus::kIndefinite);
  A = good;
  A.corner -= 500.0 * MatX::Identity(6, 6);  // only the border is indefinite
  A.touch();
  EXPECT_EQ(solver->factor(A), solver->supports_indefinite() ? SolveStatus::kOk : SolveStatus::kIndefinite);
  A = good;
  A.body.values()[5] = std::nan("");
  A.touch();
  EXPECT_EQ(solver->factor(A), SolveStatus::kSingular);
  A = good;
  A.set_zero();
  A.touch();
  EXPECT_NE(solver->factor(A), SolveStatus::kOk);
  EXPECT_EQ(solver->factor(good), SolveStatus::kOk) << "a failure leaves nothing behind";
  VecX x;
  ASSERT_EQ(solver->solve(VecX(good.to_dense() * VecX::Ones(36)), x), SolveStatus::kOk);
  EXPECT_LT((x - VecX::Ones(36)).norm(), 1e-12);
}

TEST_P(LinearSolvers, RefuseMisuse) {
  const BorderedMatrix A = random_matrix(10, 0, Kind::kSpd, 5);
  VecX x;
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  EXPECT_THROW(solver->solve(VecX::Ones(29), x), InternalError);
  BorderedMatrix bad = A;
  bad.body.values()[0] = std::nan("");
  bad.touch();
  ASSERT_NE(solver->factor(bad), SolveStatus::kOk);
  EXPECT_THROW(solver->solve(VecX::Ones(30), x), InternalError) << "no factor, no solve";
  if (!solver->supports_unsymmetric()) {
    EXPECT_THROW(solver->factor(random_matrix(10, 0, Kind::kUnsymmetric, 1)), InternalError);
  }
}

TEST_P(LinearSolvers, RefuseWhatIsNotFiniteAnywhere) {
  const BorderedMatrix good = random_matrix(10, 6, Kind::kSpd, 5);
  int refused = 0;
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    for (const int part : {0, 1, 2, 3}) {
      BorderedMatrix A = good;
      if (part == 0) A.body.values()[7] = bad;
      if (part == 1) A.right(3, 2) = bad;
      if (part == 2) A.bottom(3, 2) = bad;
      if (part == 3) A.corner(0, 0) = bad;
      A.touch();
      EXPECT_EQ(solver->factor(A), SolveStatus::kSingular) << "part " << part;
      ++refused;
    }
  EXPECT_EQ(refused, 12);
}

// A free graph of springs has no stiffness against translation: the LU factors have a pivot at rounding
// level, wherever in the order it occurs. (Rounding may make a Cholesky pivot positive.)
TEST_P(PivotingSolvers, RefuseASingularMatrix) {
  BorderedMatrix A = random_matrix(40, 0, Kind::kSpd, 9);
  for (int i = 0; i < 40; ++i) {
    const int own = A.body.slot(i, i);
    std::fill_n(A.body.block(own), 9, 0.0);
    for (int s = A.body.row_start()[static_cast<std::size_t>(i)];
         s < A.body.row_start()[static_cast<std::size_t>(i) + 1]; ++s) {
      const int j = A.body.columns()[static_cast<std::size_t>(s)];
      if (j == i) continue;
      const double k = 1.0 + 0.1 * ((i * j) % 7);  // equal for (j, i)
      std::fill_n(A.body.block(s), 9, 0.0);
      A.body.add(s, -k * Mat3::Identity());
      A.body.add(own, k * Mat3::Identity());
    }
  }
  A.touch();
  ASSERT_LT((A.to_dense() * VecX::Ones(120)).norm(), 1e-12);
  EXPECT_EQ(solver->factor(A), SolveStatus::kSingular);
}

// A kept pivot order is applied to values for which it was not chosen: the diagonal vanishes, and the
// order of the first factorisation would divide by it.
TEST_P(PivotingSolvers, KeepTheirAccuracyOverChangingValues) {
  const BorderedMatrix first = random_matrix(30, 0, Kind::kUnsymmetric, 2);
  for (const double share : {1.0, 0.9, 1e-3, 1e-6, 1e-9, 0.0, 1.0}) {
    BorderedMatrix A = first;
    for (int i = 0; i < 30; ++i)
      for (int axis = 0; axis < 3; ++axis) A.body.block(A.body.slot(i, i))[4 * axis] *= share;
    A.touch();
    ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
    VecX x;
    ASSERT_EQ(solver->solve(VecX(A.to_dense() * VecX::Ones(90)), x), SolveStatus::kOk);
    EXPECT_LT((x - VecX::Ones(90)).norm(), 1e-10) << "diagonal times " << share;
  }
  EXPECT_EQ(solver->counters().symbolic, 1);
}

TEST_P(LinearSolvers, RobustOnesTakeAnyMatrix) {
  const auto robust = integrate::make_robust_linear_solver(GetParam(), {.linear_rtol = 1e-14});
  for (const Kind kind : {Kind::kSpd, Kind::kIndefinite, Kind::kUnsymmetric}) {
    const BorderedMatrix A = random_matrix(30, 6, kind, 11);
    ASSERT_EQ(robust->factor(A), SolveStatus::kOk);
    MatX X = A.to_dense() * MatX::Ones(96, 3);
    ASSERT_EQ(robust->solve(X, X), SolveStatus::kOk);
    EXPECT_LT((X - MatX::Ones(96, 3)).norm(), 1e-11);
  }
}

// --- Conjugate gradients

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

TEST(LinearSolverRegistry, NamesTheNearest) {
  try {
    linear::make_linear_solver("cholmud");
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "unknown linear solver \"cholmud\" (did you mean \"cholmod\"?)");
  }
}

TEST(LinearSolverRegistry, IsAskedForTheMethodsOwnWhereTheSpecNamesNone) {
  int automatic = 0, factored = 0, none = 0;
  for (const auto& entry : integrate::stepper_registry()) {
    const std::string own = integrate::linear_solver_of({.name = entry.name});
    EXPECT_EQ(own.empty(), !entry.traits.implicit) << entry.name;
    EXPECT_EQ(integrate::linear_solver_of({.name = entry.name, .linear_solver = "umfpack"}),
              entry.traits.implicit ? "umfpack" : "")
        << entry.name;
    EXPECT_TRUE(own != "auto" || entry.traits.control == StepControl::kFixed)
        << entry.name << ": error control keeps its factors";
    EXPECT_EQ(integrate::linear_solver_of({.name = entry.name, .factor_kept_steps = 4}),
              own == "auto" ? "cholmod" : own)
        << entry.name;
    automatic += own == "auto", factored += own == "cholmod", none += own.empty();
  }
  EXPECT_EQ(automatic, 6) << "linearly implicit Euler, and those with Newton iterations of their own";
  EXPECT_EQ(automatic + factored + none, static_cast<int>(integrate::stepper_registry().size()));
  EXPECT_GT(factored, 20);
  EXPECT_GT(none, 5);
  EXPECT_THROW(integrate::linear_solver_of({.name = "leapfrog"}), Error);
}

}  // namespace
}  // namespace palpate
