#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include "linear/bent_beam.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace dynamics;

class NodeSolvers : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Registry, NodeSolvers, testing::Values("pcg-single", "pcg-two-level"),
                         [](const auto& p) {
                           std::string name = p.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// linear_rtol bounds the error of the solution in the energy norm, against a direct solve, over a motion,
// with start values from the last steps.
TEST_P(NodeSolvers, TheErrorIsWhatTheToleranceSays) {
  int checked = 0;
  for (const double E : {1e5, 1e6})
    for (const double h : {1e-3, 1e-2})
      for (const double rtol : {1e-3, 1e-6, 1e-9}) {
        BentBeam beam(16, E);
        const auto solver = linear::make_linear_solver(GetParam(), {.step_s = h, .linear_rtol = rtol});
        const auto direct = linear::make_linear_solver("cholmod");
        BorderedMatrix A;
        VecX b, x, exact;
        for (int k = 0; k < 8; ++k) {
          beam.at(0.2 * k, h, A, b);
          ASSERT_EQ(direct->factor(A), SolveStatus::kOk);
          ASSERT_EQ(direct->solve(b, exact), SolveStatus::kOk);
          ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
          ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
          EXPECT_LE(energy_norm(A, x - exact), rtol * energy_norm(A, exact))
              << "E " << E << ", h " << h << ", rtol " << rtol << ", step " << k;
          ++checked;
        }
        EXPECT_EQ(solver->counters().symbolic, 1);
      }
  EXPECT_EQ(checked, 96);
}

// A zero-row-sum matrix with off-diagonal blocks in single precision satisfies the same bound: against a
// direct solve of the whole matrix in double. Between four elements and one across, where rounding of the
// blocks matters most; between matrices dominated by mass and by stiffness. Where it is too coarse for the
// tolerance, the solver reports this, and corrects the residual of the equations with it, from the first step
// on.
TEST_P(NodeSolvers, TheErrorIsWhatTheToleranceSaysOfAZeroRowSumMatrix) {
  int checked = 0, rounded = 0;
  for (const int across : {4, 1})
    for (const double E : {1e4, 1e5, 1e6})
      for (const double rtol : {1e-3, 1e-6, 1e-7, 1e-9}) {
        BentBeam beam(across == 1 ? 64 : 16, E, across);
        const double h = 1e-2;
        const auto solver = linear::make_linear_solver(GetParam(), {.step_s = h, .linear_rtol = rtol});
        const auto direct = linear::make_linear_solver("cholmod");
        BorderedMatrix whole;
        VecX b, x, exact;
        for (int k = 0; k < 6; ++k) {
          beam.at(0.2 * k, h, whole, b);
          ASSERT_EQ(direct->factor(whole), SolveStatus::kOk);
          ASSERT_EQ(direct->solve(b, exact), SolveStatus::kOk);
          ZeroRowSumMatrix* A = mixed(*solver).step_matrix(beam.pattern());
          ASSERT_NE(A, nullptr);
          beam.at(0.2 * k, h, *A, b);
          const StepMatrixUse use = mixed(*solver).factor_step_matrix();
          ASSERT_TRUE(use == StepMatrixUse::kRefine || use == StepMatrixUse::kSolve);
          if (use == StepMatrixUse::kRefine) {
            Known left(whole, b);
            ASSERT_EQ(mixed(*solver).solve_by_refinement(left, x), SolveStatus::kOk)
                << across << " across, E " << E << ", rtol " << rtol << ", step " << k;
            EXPECT_GE(left.evaluated, 2) << "none is believed unseen";
            ++rounded;
          } else
            ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk)
                << across << " across, E " << E << ", rtol " << rtol << ", step " << k << ", iterations "
                << solver->counters().iterations;
          EXPECT_LE(energy_norm(whole, x - exact), rtol * energy_norm(whole, exact))
              << across << " across, E " << E << ", rtol " << rtol << ", step " << k;
          ++checked;
        }
        EXPECT_EQ(solver->counters().symbolic, 1);
        EXPECT_EQ(solver->counters().lagged, 0) << "each had its own";
      }
  EXPECT_EQ(checked, 144);
  EXPECT_GE(rounded, 48);
}

// Whole and zero-row-sum matrices of one pattern alternate: one analysis, and remembered solutions serve
// both.
TEST_P(NodeSolvers, TakeWholeAndZeroRowSumMatricesInTurn) {
  BentBeam beam(16, 1e5);
  const auto solver = linear::make_linear_solver(GetParam(), {.linear_rtol = 1e-4});
  BorderedMatrix whole;
  VecX b, x, y;
  beam.at(0.5, 1e-2, whole, b);
  ASSERT_EQ(solver->factor(whole), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  const long cold = solver->counters().iterations;
  ZeroRowSumMatrix* A = mixed(*solver).step_matrix(beam.pattern());
  ASSERT_NE(A, nullptr);
  beam.at(0.5, 1e-2, *A, b);
  ASSERT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kSolve);
  ASSERT_EQ(solver->solve(b, y), SolveStatus::kOk);
  EXPECT_LE(solver->counters().iterations - cold, cold / 4);
  EXPECT_LE(energy_norm(whole, x - y), 2e-4 * energy_norm(whole, x));
  ASSERT_EQ(solver->solve(VecX(2.0 * b), y), SolveStatus::kOk) << "a second right-hand side";
  EXPECT_LE(energy_norm(whole, 2.0 * x - y), 4e-4 * energy_norm(whole, x));
  ASSERT_EQ(solver->factor(whole), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, y), SolveStatus::kOk);
  EXPECT_LE(energy_norm(whole, x - y), 2e-4 * energy_norm(whole, x));
  EXPECT_EQ(solver->counters().symbolic, 1);
}

TEST_P(NodeSolvers, SayWhatTheyCannotDoWithAZeroRowSumMatrix) {
  BentBeam beam(8, 1e5);
  const auto solver = linear::make_linear_solver(GetParam(), {.linear_rtol = 1e-4});
  ZeroRowSumMatrix* A = mixed(*solver).step_matrix(beam.pattern());
  ASSERT_NE(A, nullptr);
  VecX b;
  beam.at(0.5, 1e-2, *A, b);
  A->values[9 * static_cast<std::size_t>(A->slot_map[1]) + 4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kNone);
  beam.at(0.5, 1e-2, *A, b);
  A->diagonal *= -1e6;
  EXPECT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kIndefinite);
  beam.at(0.5, 1e-2, *A, b);
  EXPECT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kSolve);
}

// Without a right-hand side there is nothing to start from, and nothing to solve.
TEST_P(NodeSolvers, RefineZeroToZero) {
  BentBeam beam(8, 1e6);
  const auto solver = linear::make_linear_solver(GetParam(), {.linear_rtol = 1e-9});
  BorderedMatrix whole;
  VecX b, x;
  beam.at(0.5, 1e-2, whole, b);
  ZeroRowSumMatrix* A = mixed(*solver).step_matrix(beam.pattern());
  ASSERT_NE(A, nullptr);
  beam.at(0.5, 1e-2, *A, b);
  ASSERT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kRefine);
  Known left(whole, VecX::Zero(b.size()));
  ASSERT_EQ(mixed(*solver).solve_by_refinement(left, x), SolveStatus::kOk);
  EXPECT_EQ(x, VecX(VecX::Zero(b.size())));
}

// A system that does not belong to the matrix differs by more than rounding: this is reported, and
// zero-row-sum matrices of this pattern are rejected for a while, whatever other patterns occur in between.
TEST_P(NodeSolvers, RefuseARoundedMatrixThatCorrectsNothing) {
  BentBeam beam(8, 1e6);
  const auto solver = linear::make_linear_solver(GetParam(), {.linear_rtol = 1e-9});
  BorderedMatrix whole;
  VecX b, x;
  beam.at(0.5, 1e-2, whole, b);
  ASSERT_EQ(solver->factor(whole), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  ZeroRowSumMatrix* A = mixed(*solver).step_matrix(beam.pattern());
  ASSERT_NE(A, nullptr);
  beam.at(1.5, 1e-2, *A, b);
  ASSERT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kRefine);
  EXPECT_THROW(solver->solve(b, x), InternalError) << "a solution is not what it is good for";
  Known left(whole, b);
  EXPECT_EQ(mixed(*solver).solve_by_refinement(left, x), SolveStatus::kNotConverged);
  EXPECT_EQ(mixed(*solver).solve_by_refinement(left, x), std::nullopt) << "it refines nothing any more";
  EXPECT_EQ(left.evaluated, 2);
  BentBeam other(8, 1e6, 3);  // another pattern, as of a matrix with contact
  BorderedMatrix elsewhere;
  int refused = 0;
  for (; refused < 1000 && !mixed(*solver).step_matrix(beam.pattern()); ++refused) {
    if (refused != 10) continue;
    other.at(0.5, 1e-2, elsewhere, b);
    ASSERT_EQ(solver->factor(elsewhere), SolveStatus::kOk);
  }
  EXPECT_GE(refused, 50);
  EXPECT_LE(refused, 100);
  EXPECT_EQ(solver->counters().lagged, 0);
}

// Rows of held directions are rows of the identity: their right-hand side is their solution, and does not
// affect the rest; also in place.
TEST_P(NodeSolvers, HeldRowsStandAlone) {
  BentBeam beam(8, 1e5);
  const auto solver = linear::make_linear_solver(GetParam(), {.linear_rtol = 1e-6});
  ZeroRowSumMatrix* A = mixed(*solver).step_matrix(beam.pattern());
  ASSERT_NE(A, nullptr);
  VecX b, x;
  beam.at(0.5, 1e-2, *A, b);
  ASSERT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kSolve);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  ASSERT_FALSE(A->held->empty());
  VecX y = b;
  for (const HeldNode& held : *A->held)
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(x[3 * held.node + axis], 0.0);
      y[3 * held.node + axis] = 1.0 + axis;
    }
  ASSERT_EQ(solver->solve(y, y), SolveStatus::kOk);
  for (const HeldNode& held : *A->held)
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(y[3 * held.node + axis], 1.0 + axis);
  for (const HeldNode& held : *A->held) y.segment<3>(3 * held.node).setZero();
  EXPECT_LT((x - y).norm(), 1e-5 * x.norm());
}

TEST_P(NodeSolvers, ThreadsDoNotChangeABit) {
  std::vector<VecX> answers;
  for (const int threads : {1, 2, 3}) {
    BentBeam beam(16, 1e5);
    const auto solver = linear::make_linear_solver(GetParam(), {.linear_rtol = 1e-6, .threads = threads});
    BorderedMatrix A;
    VecX b, x, all(0);
    for (int k = 0; k < 4; ++k) {
      beam.at(0.3 * k, 1e-2, A, b);
      ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
      ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
      all.conservativeResize(all.size() + 2 * x.size());
      all.tail(x.size()) = x;
      ZeroRowSumMatrix* step = mixed(*solver).step_matrix(beam.pattern());
      ASSERT_NE(step, nullptr);
      beam.at(0.3 * k, 1e-2, *step, b);
      ASSERT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kSolve);
      ASSERT_EQ(solver->solve(VecX(b.reverse().cwiseProduct((b.array() != 0.0).cast<double>().matrix())), x),
                SolveStatus::kOk);
      all.segment(all.size() - 2 * x.size(), x.size()) = x;
    }
    answers.push_back(all);
  }
  EXPECT_EQ(answers[0], answers[1]);
  EXPECT_EQ(answers[0], answers[2]);
}

// A matrix solved before is solved from remembered solutions; a second right-hand side of the same
// factorisation starts from products with its matrix.
TEST_P(NodeSolvers, StartFromTheLastSolutions) {
  BentBeam beam(16, 1e5);
  const auto solver = linear::make_linear_solver(GetParam(), {.linear_rtol = 1e-4});
  BorderedMatrix A;
  VecX b, c, x, exact;
  beam.at(0.5, 1e-2, A, b);
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  const long cold = solver->counters().iterations;
  EXPECT_GT(cold, 5);
  ASSERT_EQ(solver->solve(VecX(-3.0 * b), x), SolveStatus::kOk);
  EXPECT_LE(solver->counters().iterations - cold, cold / 4);
  c = VecX::LinSpaced(b.size(), -1.0, 2.0);
  ASSERT_EQ(solver->solve(c, x), SolveStatus::kOk);
  const auto direct = linear::make_linear_solver("cholmod");
  ASSERT_EQ(direct->factor(A), SolveStatus::kOk);
  ASSERT_EQ(direct->solve(c, exact), SolveStatus::kOk);
  EXPECT_LE(energy_norm(A, x - exact), 1e-4 * energy_norm(A, exact));
  ASSERT_EQ(solver->solve(VecX(VecX::Zero(b.size())), x), SolveStatus::kOk);
  EXPECT_EQ(x, VecX(VecX::Zero(b.size())));
}

// Units: the same problem in other units of force has the same bits up to a power of two, far outside of the
// range of single precision.
TEST_P(NodeSolvers, TakeAnyUnits) {
  BentBeam beam(8, 1e5);
  BorderedMatrix A;
  VecX b, x, scaled;
  beam.at(0.5, 1e-2, A, b);
  const auto solver = linear::make_linear_solver(GetParam(), {.linear_rtol = 1e-6});
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  for (const double unit : {std::ldexp(1.0, 200), std::ldexp(1.0, -200)}) {
    BorderedMatrix B = A;
    for (double& value : B.body.values()) value *= unit;
    B.touch();
    const auto other = linear::make_linear_solver(GetParam(), {.linear_rtol = 1e-6});
    ASSERT_EQ(other->factor(B), SolveStatus::kOk);
    ASSERT_EQ(other->solve(b, scaled), SolveStatus::kOk);
    EXPECT_EQ(VecX(unit * scaled), x);
  }
}

// Remembered solutions are in single precision: a solution that is larger or smaller by far than the previous
// ones neither benefits from them nor corrupts later solves.
TEST_P(NodeSolvers, TakeSolutionsOfAnySizeOneAfterTheOther) {
  BentBeam beam(8, 1e5);
  const auto solver = linear::make_linear_solver(GetParam(), {.linear_rtol = 1e-4});
  const auto direct = linear::make_linear_solver("cholmod");
  BorderedMatrix A;
  VecX b, x, exact;
  long cold = 0, last = 0;
  const auto iterations_of = [&](const VecX& c) {
    EXPECT_EQ(direct->solve(c, exact), SolveStatus::kOk);
    EXPECT_EQ(solver->solve(c, x), SolveStatus::kOk);
    EXPECT_LE(energy_norm(A, x - exact), 1e-4 * energy_norm(A, exact));
    return solver->counters().iterations - std::exchange(last, solver->counters().iterations);
  };
  beam.at(0.5, 1e-2, A, b);
  ASSERT_EQ(direct->factor(A), SolveStatus::kOk);
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  cold = iterations_of(b);
  for (const double size : {std::ldexp(1.0, 150), std::ldexp(1.0, -150), 1.0}) {
    iterations_of(size * b);
    iterations_of(size * b);
    EXPECT_LE(iterations_of(-2.0 * size * b), cold / 4) << "size " << size;
  }
}

TEST_P(NodeSolvers, FindNegativeCurvatureWhileTheySolve) {
  PatternBuilder pattern(50);
  for (int i = 0; i + 1 < 50; ++i) pattern.add_pair(i, i + 1);
  BorderedMatrix A;
  A.body = pattern.build();
  for (int i = 0; i < 50; ++i)
    A.body.add(A.body.slot(i, i), (i == 0 || i == 49 ? 0.99 : 1.99) * Mat3::Identity());
  for (int i = 0; i + 1 < 50; ++i) {
    A.body.add(A.body.slot(i, i + 1), -Mat3::Identity());
    A.body.add(A.body.slot(i + 1, i), -Mat3::Identity());
  }
  A.touch();
  const auto solver = linear::make_linear_solver(GetParam());
  const SolveStatus factored = solver->factor(A);
  VecX x = VecX::Ones(150);
  if (factored == SolveStatus::kOk) { EXPECT_EQ(solver->solve(VecX(x), x), SolveStatus::kIndefinite); }
  const auto robust = integrate::make_robust_linear_solver(GetParam());
  ASSERT_EQ(robust->factor(A), SolveStatus::kOk);
  const VecX b = VecX::Ones(150);
  ASSERT_EQ(robust->solve(b, x), SolveStatus::kOk);
  VecX Ax;
  A.multiply(x, Ax);
  EXPECT_LT((Ax - b).norm(), 1e-9 * b.norm());
}

TEST_P(NodeSolvers, RefuseSettingsOutOfRange) {
  for (const double bad : {0.0, -1e-8, 0.5, std::nan("")})
    EXPECT_THROW(linear::make_linear_solver(GetParam(), {.linear_rtol = bad}), Error) << bad;
  for (const int bad : {0, -1, 65})
    EXPECT_THROW(linear::make_linear_solver(GetParam(), {.threads = bad}), Error) << bad;
}

}  // namespace
}  // namespace palpate
