#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace dynamics;

/// Springs along the edges of a square grid of nodes and along some further pairs, with each node tied to the
/// ground; node k of the grid is number[k].
BorderedMatrix grid(const std::vector<int>& number, int edge,
                    const std::vector<std::pair<int, int>>& further = {}) {
  std::vector<std::pair<int, int>> springs = further;
  for (int i = 0; i < edge; ++i)
    for (int j = 0; j < edge; ++j) {
      if (i + 1 < edge)
        springs.emplace_back(number[static_cast<std::size_t>(edge * i + j)],
                             number[static_cast<std::size_t>(edge * i + edge + j)]);
      if (j + 1 < edge)
        springs.emplace_back(number[static_cast<std::size_t>(edge * i + j)],
                             number[static_cast<std::size_t>(edge * i + j + 1)]);
    }
  PatternBuilder pattern(edge * edge);
  for (const auto& [a, b] : springs) pattern.add_pair(a, b);
  BorderedMatrix A;
  A.body = pattern.build();
  for (int n = 0; n < edge * edge; ++n) A.body.add(A.body.diagonal(n), 0.1 * Mat3::Identity());
  for (const auto& [a, b] : springs)
    for (const auto& [i, j, sign] : {std::tuple{a, a, 1.0}, {b, b, 1.0}, {a, b, -1.0}, {b, a, -1.0}})
      A.body.add(A.body.slot(i, j), sign * Mat3::Identity());
  A.right = MatX(3 * edge * edge, 0);
  A.bottom = MatX(0, 3 * edge * edge);
  A.corner = MatX(0, 0);
  A.touch();
  return A;
}

double error_of(LinearSolver& solver, const BorderedMatrix& A) {
  const VecX exact = VecX::LinSpaced(A.size(), -1.0, 1.0);
  VecX b, x;
  A.multiply(exact, b);
  EXPECT_EQ(solver.factor(A), SolveStatus::kOk);
  EXPECT_EQ(solver.solve(b, x), SolveStatus::kOk);
  return (x - exact).norm() / exact.norm();
}

}  // namespace

// Rolling contact couples other pairs at every step: the first ordering is kept, and solutions remain
// correct. A renumbered mesh is another matrix: its separators are elsewhere, the old ordering causes
// fill-in, and a new one is computed.
TEST(Ordering, IsKeptWhileItServes) {
  constexpr int kEdge = 30;
  std::vector<int> number(kEdge * kEdge);
  std::iota(number.begin(), number.end(), 0);
  const auto solver = linear::make_linear_solver("cholmod");
  EXPECT_LT(error_of(*solver, grid(number, kEdge)), 1e-12);
  EXPECT_EQ(solver->counters().orderings, 1);
  for (int step = 0; step < 5; ++step) {
    EXPECT_LT(
        error_of(*solver, grid(number, kEdge, {{step, kEdge + step + 1}, {step + 2, kEdge * 3 + step}})),
        1e-12)
        << step;
    EXPECT_EQ(solver->counters().symbolic, step + 2);
    EXPECT_EQ(solver->counters().orderings, 1) << step;
  }
  std::shuffle(number.begin(), number.end(), std::mt19937(3));
  EXPECT_LT(error_of(*solver, grid(number, kEdge)), 1e-12);
  EXPECT_EQ(solver->counters().orderings, 2);
  std::vector<int> fewer(100);
  std::iota(fewer.begin(), fewer.end(), 0);
  EXPECT_LT(error_of(*solver, grid(fewer, 10)), 1e-12) << "of another size";
  EXPECT_EQ(solver->counters().orderings, 3);
}

}  // namespace palpate
