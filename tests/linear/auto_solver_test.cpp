#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "core/counters.h"
#include "linear/auto_choice.h"
#include "linear/bent_beam.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace dynamics;

// Rows of M + h^2 K sum to those of M: the number equals its definition, from masses and diagonal.
TEST(Auto, ReadsTheStiffnessNumberFromTheMatrix) {
  // the last case has rows that are not sampled
  for (const auto& [cells, h] : {std::pair{16, 1e-4}, {16, 1e-2}, {36, 1e-3}}) {
    BentBeam beam(cells, 1e5);
    BorderedMatrix A;
    VecX b;
    beam.at(0.6, h, A, b);
    double own = 0.0, mass = 0.0;
    for (int i = 0; i < A.body.block_rows(); ++i) {
      if (beam.rest[3 * i] < -0.5 + 0.1) continue;  // held, or next to a held node
      const double* block = A.body.block(A.body.diagonal(i));
      own += block[0] + block[4] + block[8];
      mass += 3.0 * beam.masses[i];
    }
    EXPECT_NEAR(linear::squared_courant_number(A.body), own / mass, 0.1 * own / mass);
  }
}

TEST(Auto, SolvesSoftAndStiffMatrices) {
  int checked = 0;
  for (const auto& [cells, E] : {std::pair{8, 1e5}, {8, 1e9}, {24, 1e5}, {24, 1e8}}) {
    BentBeam beam(cells, E);
    const auto solver = linear::make_linear_solver("auto", {.linear_rtol = 1e-6}),
               direct = linear::make_linear_solver("cholmod");
    BorderedMatrix A;
    VecX b, x, exact;
    beam.at(0.4, 1e-2, A, b);
    ASSERT_EQ(direct->factor(A), SolveStatus::kOk);
    ASSERT_EQ(direct->solve(b, exact), SolveStatus::kOk);
    ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
    ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
    EXPECT_LE(energy_norm(A, x - exact), 1e-6 * energy_norm(A, exact)) << cells << " cells, E " << E;
    ++checked;
  }
  EXPECT_EQ(checked, 4);
}

/// Solves zero-row-sum matrices of the beam at given steps, one after the other, to the solver's tolerance;
/// counts the solvers created.
class AutoOnZeroRowSum : public testing::Test {
 protected:
  static constexpr double kRtol = 1e-3;
  BentBeam beam{24, 1e5};
  std::unique_ptr<LinearSolver> solver = linear::make_linear_solver("auto", {.linear_rtol = kRtol});
  std::string expected(double h) { return expected(beam, h); }
  std::string expected(BentBeam& of, double h) {
    BorderedMatrix A;
    VecX b;
    of.at(0.4, h, A, b);
    return linear::prefers_two_level(linear::squared_courant_number(A.body)) ? "pcg-two-level" : "pcg-single";
  }
  void solve(double h) { solve(beam, h); }
  void solve(BentBeam& of, double h) {
    BorderedMatrix whole;
    VecX b, x, exact;
    of.at(0.4, h, whole, b);
    ZeroRowSumMatrix* A = mixed(*solver).step_matrix(of.pattern());
    ASSERT_NE(A, nullptr);
    of.at(0.4, h, *A, b);
    ASSERT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kSolve);
    ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
    const auto direct = linear::make_linear_solver("cholmod");
    ASSERT_EQ(direct->factor(whole), SolveStatus::kOk);
    ASSERT_EQ(direct->solve(b, exact), SolveStatus::kOk);
    EXPECT_LE(energy_norm(whole, x - exact), kRtol * energy_norm(whole, exact)) << h;
  }
  static long made(const std::string& name) { return counters::snapshot()["integrate.solver." + name]; }
};

TEST_F(AutoOnZeroRowSum, ChoosesByWhatItSawOfTheFirst) {
  constexpr double kSoft = 1e-4, kStiff = 0.1;
  ASSERT_EQ(expected(kSoft), "pcg-single");
  ASSERT_EQ(expected(kStiff), "pcg-two-level");
  const long single = made("pcg-single"), two_level = made("pcg-two-level");
  solve(kSoft);
  EXPECT_EQ(made("pcg-two-level"), two_level + 1) << "for now";
  EXPECT_EQ(made("pcg-single"), single);
  solve(kSoft);
  EXPECT_EQ(made("pcg-single"), single + 1);
  EXPECT_EQ(solver->counters().solves, 2) << "of both";
  EXPECT_EQ(solver->counters().refreshes, 1);
  solve(kStiff);
  EXPECT_EQ(solver->counters().refreshes, 1) << "by the solver of the last one";
  solve(kStiff);
  EXPECT_EQ(solver->counters().refreshes, 2) << "and by its own";
  EXPECT_EQ(made("pcg-two-level"), two_level + 2);
  EXPECT_EQ(solver->counters().solves, 4);
}

TEST_F(AutoOnZeroRowSum, KeepsItsChoiceWhileItServes) {
  const long before = made("pcg-single") + made("pcg-two-level");
  for (const double h : {0.05, 0.06, 0.08, 0.05}) solve(h);
  EXPECT_EQ(made("pcg-single") + made("pcg-two-level"), before + 1);
  EXPECT_EQ(solver->counters().symbolic, 1);
}

TEST_F(AutoOnZeroRowSum, ChoosesAnewForAnotherBody) {
  BentBeam small(8, 1e5);
  ASSERT_EQ(expected(0.1), "pcg-two-level");
  ASSERT_EQ(expected(small, 1e-4), "pcg-single");
  solve(0.1);
  solve(0.1);
  const long single = made("pcg-single");
  solve(small, 1e-4);
  EXPECT_EQ(made("pcg-single"), single);
  solve(small, 1e-4);
  EXPECT_EQ(made("pcg-single"), single + 1);
  EXPECT_EQ(solver->counters().solves, 4);
}

// An unsymmetric matrix is solved by GMRES; zero-row-sum matrices after it are solved as before.
TEST_F(AutoOnZeroRowSum, ReturnsToItsChoiceAfterAnUnsymmetricMatrix) {
  for (const double h : {1e-4, 0.1}) {
    solve(h);
    solve(h);
    BorderedMatrix whole;
    VecX b, x;
    beam.at(0.4, h, whole, b);
    whole.symmetric = false;
    ASSERT_EQ(solver->factor(whole), SolveStatus::kOk);
    ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
    const long single = made("pcg-single"), two_level = made("pcg-two-level");
    EXPECT_EQ(mixed(*solver).lagged_matrix(), nullptr) << "GMRES has none";
    solve(h);
    EXPECT_NE(mixed(*solver).lagged_matrix(), nullptr);
    EXPECT_EQ(made("pcg-single"), single) << "none was made anew";
    EXPECT_EQ(made("pcg-two-level"), two_level);
  }
}

// Measurements of a zero-row-sum matrix are discarded when a whole matrix follows.
TEST_F(AutoOnZeroRowSum, ForgetsWhatItSawWhenAWholeMatrixComes) {
  solve(1e-4);
  BorderedMatrix whole;
  VecX b, x;
  beam.at(0.4, 0.1, whole, b);
  ASSERT_EQ(solver->factor(whole), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  const long single = made("pcg-single");
  solve(0.1);
  EXPECT_EQ(made("pcg-single"), single);
}

}  // namespace
}  // namespace palpate
