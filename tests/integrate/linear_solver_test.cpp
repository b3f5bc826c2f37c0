#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "integrate/registry_test_name.h"
#include "palpate/integrate/integrators.h"

namespace palpate {
namespace {

using namespace dynamics;

enum class Kind { kSpd, kUnsymmetric };

/// Random bordered matrix with a dominant diagonal: positive definite, or (values of the two triangles drawn apart) unsymmetric.
BorderedMatrix random_matrix(int nodes, int border, Kind kind, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::uniform_int_distribution<int> node(0, std::max(0, nodes - 1));
  PatternBuilder pattern(nodes);
  for (int i = 0; i < 4 * nodes; ++i) pattern.add_pair(node(random), node(random));
  BorderedMatrix A;
  A.body = pattern.build();
  A.symmetric = kind == Kind::kSpd;
  for (int i = 0; i < nodes; ++i)
    for (int s = A.body.row_start()[static_cast<std::size_t>(i)]; s < A.body.row_start()[static_cast<std::size_t>(i) + 1]; ++s) {
      const int j = A.body.columns()[static_cast<std::size_t>(s)];
      const Mat3 m = Mat3::NullaryExpr([&] { return value(random); });
      if (i == j)
        A.body.add(s, 60.0 * Mat3::Identity() + (A.symmetric ? Mat3(m + m.transpose()) : m));
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
  A.corner = (3.0 * nodes + 60.0) * MatX::Identity(border, border) + c + c.transpose();
  A.touch();
  return A;
}

class LinearSolvers : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<LinearSolver> solver = integrate::make_linear_solver(GetParam());
  std::vector<Kind> kinds() const {
    return solver->supports_unsymmetric() ? std::vector{Kind::kSpd, Kind::kUnsymmetric} : std::vector{Kind::kSpd};
  }
};

std::vector<std::string> solver_names() { return names(integrate::linear_solver_registry()); }
INSTANTIATE_TEST_SUITE_P(Registry, LinearSolvers, testing::ValuesIn(solver_names()), registry_test_name);

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
  EXPECT_EQ(solver->factor(A), solver->supports_unsymmetric() ? SolveStatus::kOk : SolveStatus::kIndefinite);
  A = good;
  A.corner -= 500.0 * MatX::Identity(6, 6);  // only the border is indefinite
  A.touch();
  EXPECT_EQ(solver->factor(A), solver->supports_unsymmetric() ? SolveStatus::kOk : SolveStatus::kIndefinite);
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

TEST(LinearSolverRegistry, NamesTheNearest) {
  try {
    integrate::make_linear_solver("cholmud");
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "unknown linear solver \"cholmud\" (did you mean \"cholmod\"?)");
  }
}

}  // namespace
}  // namespace palpate
