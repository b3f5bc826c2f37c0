#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "integrate/bent_beam.h"
#include "integrate/linear/auto_choice.h"
#include "palpate/integrate/integrators.h"

namespace palpate {
namespace {

using namespace dynamics;

// Rows of M + h^2 K sum to those of M: the number is what the definition says, from masses and diagonal.
TEST(Auto, ReadsTheStiffnessNumberFromTheMatrix) {
  for (const auto& [cells, h] : {std::pair{16, 1e-4}, {16, 1e-2}, {36, 1e-3}}) {  // the last has rows that are not looked at
    BentBeam beam(cells, 1e5);
    BorderedMatrix A;
    VecX b;
    beam.at(0.6, h, A, b);
    double own = 0.0, mass = 0.0;
    for (int i = 0; i < A.body.block_rows(); ++i) {
      if (beam.rest[3 * i] < -0.5 + 0.1) continue;  // held, or beside what is held
      const double* block = A.body.block(A.body.diagonal(i));
      own += block[0] + block[4] + block[8];
      mass += 3.0 * beam.masses[i];
    }
    EXPECT_NEAR(integrate::stiffness_number(A.body), own / mass, 0.1 * own / mass);
  }
}

TEST(Auto, AnswersWhateverTheTableChooses) {
  int checked = 0;
  for (const auto& [cells, E] : {std::pair{8, 1e5}, {8, 1e9}, {24, 1e5}, {24, 1e8}}) {
    BentBeam beam(cells, E);
    const auto solver = integrate::make_linear_solver("auto", {.linear_rtol = 1e-6}), direct = integrate::make_linear_solver("cholmod");
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

// A matrix far from the last one sends the choice back to a whole one.
TEST(Auto, KeepsItsChoiceForBalancedMatricesWhileItServes) {
  BentBeam beam(24, 1e5);
  const auto solver = integrate::make_linear_solver("auto", {.linear_rtol = 1e-3});
  EXPECT_EQ(solver->balanced(beam.pattern()), nullptr) << "nothing was chosen yet";
  BorderedMatrix whole;
  VecX b, x, exact;
  beam.at(0.4, 1e-2, whole, b);
  ASSERT_EQ(solver->factor(whole), SolveStatus::kOk);
  BalancedMatrix* A = solver->balanced(beam.pattern());
  ASSERT_NE(A, nullptr);
  beam.at(0.4, 1e-2, *A, b);
  ASSERT_EQ(solver->factor_balanced(), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  const auto direct = integrate::make_linear_solver("cholmod");
  ASSERT_EQ(direct->factor(whole), SolveStatus::kOk);
  ASSERT_EQ(direct->solve(b, exact), SolveStatus::kOk);
  EXPECT_LE(energy_norm(whole, x - exact), 1e-3 * energy_norm(whole, exact));
  A = solver->balanced(beam.pattern());
  beam.at(0.4, 1e-1, *A, b);
  EXPECT_NE(solver->factor_balanced(), SolveStatus::kOk);
}

}  // namespace
}  // namespace palpate
