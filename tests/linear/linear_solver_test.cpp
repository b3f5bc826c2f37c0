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
  EXPECT_EQ(automatic, 7) << "linearly implicit Euler, and those with Newton iterations of their own";
  EXPECT_EQ(automatic + factored + none, static_cast<int>(integrate::stepper_registry().size()));
  EXPECT_GT(factored, 20);
  EXPECT_GT(none, 5);
  EXPECT_THROW(integrate::linear_solver_of({.name = "leapfrog"}), Error);
}

}  // namespace
}  // namespace palpate
