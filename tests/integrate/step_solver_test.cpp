// Fallbacks of an implicit step whose linear solver fails.
#include "integrate/step_solver.h"

#include <gtest/gtest.h>

#include "core/counters.h"
#include "linear/unsymmetric_matrices.h"
#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace dynamics;

// With a border the iteration fails while the matrix is factored, without a border at the right-hand side.
TEST(StepSolver, LeavesAnUnsymmetricMatrixToLuWhereTheIterationDoesNotConverge) {
  for (const int border : {0, 6}) {
    BorderedMatrix A = spinning_nodes(60, 20.0);
    add_border(A, border, 400.0);
    integrate::StepSolver solver(linear::make_linear_solver("cholmod"), {});
    System system;
    int reassembled = 0;
    const auto reassemble = [&] { ++reassembled; };
    const VecX b = VecX::LinSpaced(A.size(), -1.0, 3.0);
    const auto right_hand_side = [&]() -> const VecX& { return b; };
    const long before = counters::counter("integrate.matrices_left_to_lu");
    VecX x, Ax;
    ASSERT_EQ(solver.factor(A, system, reassemble), SolveStatus::kOk) << border;
    ASSERT_EQ(solver.solve(system, reassemble, right_hand_side, x), SolveStatus::kOk) << border;
    A.multiply(x, Ax);
    EXPECT_LE((Ax - b).norm(), 1e-11 * b.norm()) << border;
    StepperCounters counted;
    solver.report(counted);
    EXPECT_EQ(counted.unconverged, 1) << border;
    EXPECT_EQ(counters::counter("integrate.matrices_left_to_lu"), before + 1) << border;
    EXPECT_EQ(counted.lu, 1) << border;
    EXPECT_EQ(counted.indefinite, 0) << border;
    EXPECT_EQ(reassembled, 0) << border << ": nothing is projected";
  }
}

}  // namespace
}  // namespace palpate
