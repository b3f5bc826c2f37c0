// Matrices with sums outside of their sparsity pattern, such as contact.
#include "linear/mixed_precision/point_operator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <utility>

#include "linear/bent_beam.h"
#include "linear/random_points.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace dynamics;

/// Adds sums on the same nodes, or on all but one of them.
PointStiffness on_the_same_nodes(const PointStiffness& C, double size) {
  PointStiffness out = C;
  for (const auto& one : C.points) {
    out.points.push_back({one.nodes, one.weight, size * one.C});
    if (!one.nodes.relative) {  // on all of these nodes except the last
      PointStiffness::OfPoint fewer = one;
      const int last = --fewer.nodes.count;
      fewer.nodes.node[static_cast<std::size_t>(last)] = 0;
      fewer.weight[last] = 0.0;
      out.points.push_back(fewer);
      out.points.push_back(one);
    }
    PointStiffness::Weights w = PointStiffness::Weights::Zero();
    w.head(one.nodes.count).setConstant(0.25);
    if (one.nodes.relative) w.tail(one.nodes.count / 2) *= -1.0;
    const Mat3 C3 = Vec3(1.0, 2.0, 3.0).asDiagonal();
    out.points.push_back({one.nodes, w, C3 + 0.1 * Mat3::Ones()});
  }
  return out;
}

/// Returns A + C in one pattern, without C in held directions.
BorderedMatrix with(const BorderedMatrix& A, const PointStiffness& C, const std::vector<HeldNode>& held) {
  BorderedMatrix out = A;
  PatternBuilder builder(A.body.block_rows());
  const auto for_each_slot = [&](auto visit) {
    for (int i = 0; i < A.body.block_rows(); ++i)
      for (int s = A.body.row_start()[static_cast<std::size_t>(i)];
           s < A.body.row_start()[static_cast<std::size_t>(i) + 1]; ++s)
        visit(i, A.body.columns()[static_cast<std::size_t>(s)], s);
  };
  for_each_slot([&](int i, int j, int) { builder.add_pair(i, j); });
  for_each_block(C, [&](int i, int j, const Mat3&) { builder.add_pair(i, j); });
  out.body = builder.build();
  for_each_slot([&](int i, int j, int s) {
    out.body.add(out.body.slot(i, j),
                 Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(A.body.block(s)));
  });
  const auto is_held = [&](int node) {
    return std::any_of(held.begin(), held.end(), [&](const HeldNode& h) { return h.node == node; });
  };
  for_each_block(C, [&](int i, int j, const Mat3& block) {
    if (!is_held(i) && !is_held(j)) out.body.add(out.body.slot(i, j), block);
  });
  out.touch();
  return out;
}

}  // namespace

// Products with the sums equal products with their blocks, part by part, and p . C p is the total over the
// parts.
TEST(PointOperator, ProductsAreThoseOfItsBlocks) {
  constexpr int kNodes = 50;
  constexpr double kScale = 0.25;
  const Order order(kNodes);
  const PointStiffness C = on_the_same_nodes(random_points(kNodes, 40, 3.0, 1), 2.0);
  linear::PointOperator op;
  op.take(random_points(kNodes, 9, 1.0, 4), {}, order.place, order.order, 2.0);  // must leave no trace
  op.take(C, {}, order.place, order.order, kScale);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> x(4 * kNodes, 0.0), expected(4 * kNodes, 0.0), y(4 * kNodes, 0.0);
  for (int k = 0; k < kNodes; ++k)
    for (int axis = 0; axis < 3; ++axis) x[static_cast<std::size_t>(4 * k + axis)] = uniform(random);
  const std::vector<float> p(x.begin(), x.end());
  std::vector<float> q(4 * kNodes, 0.0f);
  double energy = 0.0;
  for_each_block(C, [&](int i, int j, const Mat3& block) {
    const auto at = [&](std::vector<double>& v, int node) {
      return Eigen::Map<Vec3>(v.data() + 4 * order.place[static_cast<std::size_t>(node)]);
    };
    at(expected, i) += block * at(x, j);
    energy += at(x, i).dot(block * at(x, j));
  });
  double share = 0.0;
  for (const std::size_t part : {0u, 1u}) {
    op.product(part, x.data(), y.data());
    share += op.product(part, p.data(), q.data());
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(y[i], expected[i], 1e-13 * 3.0 * 40);
    EXPECT_NEAR(q[i], kScale * expected[i], 2e-6 * 3.0 * 40);
  }
  EXPECT_NEAR(share, kScale * energy, 1e-5 * kScale * energy);
  // the diagonal blocks, once per node
  std::vector<Mat3> diagonal(kNodes, Mat3::Zero());
  for_each_block(C, [&](int i, int j, const Mat3& block) {
    if (i == j) diagonal[static_cast<std::size_t>(order.place[static_cast<std::size_t>(i)])] += block;
  });
  std::map<std::pair<int, int>, Mat3> blocks, seen;
  for_each_block(C, [&](int i, int j, const Mat3& block) {
    const std::pair at(order.place[static_cast<std::size_t>(i)], order.place[static_cast<std::size_t>(j)]);
    blocks.try_emplace(at, Mat3::Zero()).first->second += block;
  });
  op.for_each_block([&](int i, int j, const Eigen::Matrix3f& block) {
    EXPECT_TRUE(seen.emplace(std::pair(i, j), block.cast<double>()).second) << "each once";
  });
  EXPECT_EQ(seen.size(), blocks.size());
  for (const auto& [at, block] : blocks) {
    ASSERT_TRUE(seen.contains(at));
    EXPECT_LT((seen[at] - kScale * block).norm(), 1e-5);
  }
  std::size_t touched = 0;
  for (const Mat3& block : diagonal) touched += block.norm() > 0.0;
  EXPECT_EQ(op.diagonal().size(), touched);
  for (const auto& own : op.diagonal())
    EXPECT_LT((own.block.cast<double>() - kScale * diagonal[static_cast<std::size_t>(own.node)]).norm(),
              1e-5);
}

// A relative sum does not resist a translation of all nodes, whatever its stiffness: no rounding error
// either.
TEST(PointOperator, RelativeSumsFeelNoTranslation) {
  constexpr int kNodes = 30;
  const Order order(kNodes);
  PointStiffness C = random_points(kNodes, 40, 1e12, 1);
  std::erase_if(C.points, [](const auto& a) { return !a.nodes.relative; });
  ASSERT_GT(C.points.size(), 5u);
  linear::PointOperator op;
  op.take(C, {}, order.place, order.order, 1.0);
  std::vector<float> p(4 * kNodes, 0.0f), q(4 * kNodes, 0.0f);
  std::vector<double> y(4 * kNodes, 0.0);
  for (int k = 0; k < kNodes; ++k)
    for (int axis = 0; axis < 3; ++axis)
      p[static_cast<std::size_t>(4 * k + axis)] = 0.1f * static_cast<float>(axis + 1);
  const std::vector<double> x(p.begin(), p.end());
  double share = 0.0;
  for (const std::size_t part : {0u, 1u}) {
    share += op.product(part, p.data(), q.data());
    op.product(part, x.data(), y.data());
  }
  EXPECT_EQ(share, 0.0);
  EXPECT_EQ(*std::max_element(q.begin(), q.end()), 0.0f);
  EXPECT_EQ(*std::max_element(y.begin(), y.end()), 0.0);
}

class PointSolvers : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Registry, PointSolvers, testing::Values("pcg-single", "pcg-two-level"),
                         [](const auto& p) {
                           std::string name = p.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// linear_rtol bounds the error of the solution in the energy norm of the whole matrix including the sums,
// against a direct solve; from sums that are softer than a node's diagonal block to sums 10^5 times stiffer,
// over a motion, with new ones at each step. Stiff sums are outliers of the spectrum, as many as their rank,
// 130 here. Conjugate gradients need one iteration for each, or two with rounding; the diagonal blocks absorb
// the moderate ones.
TEST_P(PointSolvers, TheErrorIsWhatTheToleranceSays) {
  constexpr double kStep = 1e-2;
  long free_iterations = 0;
  for (const double size : {0.0, 0.1, 1e3, 1e5})
    for (const int threads : {1, 2}) {
      BentBeam beam(16, 1e5);
      IntegratorSpec spec{.step_s = kStep, .linear_rtol = 1e-4};
      spec.threads = threads;
      const auto solver = linear::make_linear_solver(GetParam(), spec);
      const auto direct = linear::make_linear_solver("cholmod");
      BorderedMatrix whole;
      VecX b, x, exact;
      int solved = 0;
      for (int k = 0; k < 6; ++k) {
        beam.at(0.2 * k, kStep, whole, b);
        const PointStiffness C =
            size > 0.0 ? random_points(whole.body.block_rows(), 30, size * 0.02, static_cast<unsigned>(k))
                       : PointStiffness{};
        const BorderedMatrix all = with(whole, C, beam.system.driven_nodes());
        ASSERT_EQ(direct->factor(all), SolveStatus::kOk);
        ZeroRowSumMatrix* A = mixed(*solver).step_matrix(beam.pattern());
        ASSERT_NE(A, nullptr);
        beam.at(0.2 * k, kStep, *A, b);
        A->points = C;
        ASSERT_EQ(direct->solve(b, exact), SolveStatus::kOk);
        const StepMatrixUse use = mixed(*solver).factor_step_matrix();
        if (use == StepMatrixUse::kRefine) {
          Known left(all, b);
          ASSERT_EQ(mixed(*solver).solve_by_refinement(left, x), SolveStatus::kOk) << size << " " << k;
        } else {
          ASSERT_EQ(use, StepMatrixUse::kSolve) << size << " " << k;
          ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk) << size << " " << k;
        }
        EXPECT_LE(energy_norm(all, x - exact), 1e-4 * energy_norm(all, exact)) << size << " " << k;
        ++solved;
      }
      EXPECT_EQ(solved, 6);
      EXPECT_EQ(solver->counters().symbolic, 1) << "the sums have no pattern";
      if (size == 0.0) free_iterations = solver->counters().iterations;
      const long outliers = size > 1e4 ? 6 * 130 : 0;
      EXPECT_LE(solver->counters().iterations, 5 * (free_iterations + outliers) / 2) << size;
    }
}

// Several solves per step, each with other sums and another right-hand side: intermediate solutions are as
// accurate as reported, and the last one is as accurate as a single solve.
TEST_P(PointSolvers, GoOnFromSolveToSolveOfAStep) {
  constexpr double kStep = 1e-2, kTolerance = 1e-4, kShare = 0.1;
  for (const int threads : {1, 2}) {
    BentBeam beam(16, 1e5);
    IntegratorSpec spec{.step_s = kStep, .linear_rtol = kTolerance};
    spec.threads = threads;
    const auto solver = linear::make_linear_solver(threads == 1 ? GetParam() : "auto", spec);
    const auto direct = linear::make_linear_solver("cholmod");
    auto& solves = dynamic_cast<dynamics::StepSolves&>(*solver);
    BorderedMatrix whole;
    VecX b, x, exact;
    int rough = 0;
    for (int k = 0; k < 4; ++k) {
      beam.at(0.2 * k, kStep, whole, b);
      ZeroRowSumMatrix* A = mixed(*solver).step_matrix(beam.pattern());
      ASSERT_NE(A, nullptr);
      beam.at(0.2 * k, kStep, *A, b);
      const VecX weight = b;
      VecX before = VecX::Zero(b.size());
      for (int solve = 0; solve < 4; ++solve) {
        const PointStiffness C = random_points(whole.body.block_rows(), 30, 2.0 + 0.3 * solve,
                                               static_cast<unsigned>(4 * k + solve % 2));
        const BorderedMatrix all = with(whole, C, beam.system.driven_nodes());
        b = (1.0 + 0.1 * solve) * weight;
        ASSERT_EQ(direct->factor(all), SolveStatus::kOk);
        ASSERT_EQ(direct->solve(b, exact), SolveStatus::kOk);
        A->points = C;
        if (solve == 0) { ASSERT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kSolve); }
        const double share = solve == 3 ? 0.0 : kShare;
        const auto solved = solve == 0 ? solves.solve_first(b, x, share) : solves.solve_next(b, x, share);
        ASSERT_EQ(solved.status, SolveStatus::kOk) << k << " " << solve;
        const double error = energy_norm(all, x - exact) / energy_norm(all, exact);
        const double way = energy_norm(all, before - exact) / energy_norm(all, exact);
        if (solved.accurate) {
          EXPECT_LE(error, kTolerance) << k << " " << solve;
        } else if (solve > 0) {
          EXPECT_LE(error, 1.01 * kShare * way) << k << " " << solve;
        }
        rough += !solved.accurate;
        EXPECT_TRUE(share > 0.0 || solved.accurate);
        before = x;
      }
      solves.end_solves(x);
    }
    EXPECT_GT(rough, 4);
    EXPECT_EQ(solver->counters().factorisations, 4);
    // auto measures the stiffness of the first matrix, and may assign the next one to another solver
    EXPECT_EQ(solver->counters().symbolic, threads == 1 ? 1 : 2);
  }
}

// Tolerances below the resolution of single precision: solutions are corrected from the first step on, with
// new sums at each, and never by a matrix in double, whose pattern would change every time.
TEST_P(PointSolvers, AreCorrectedFromTheFirstStepOn) {
  constexpr double kStep = 1e-2, kTolerance = 1e-9;
  BentBeam beam(16, 1e5);
  const auto solver = linear::make_linear_solver(GetParam(), {.step_s = kStep, .linear_rtol = kTolerance});
  const auto direct = linear::make_linear_solver("cholmod");
  BorderedMatrix whole;
  VecX b, x, exact;
  for (int k = 0; k < 4; ++k) {
    beam.at(0.2 * k, kStep, whole, b);
    const PointStiffness C = random_points(whole.body.block_rows(), 30, 2.0, static_cast<unsigned>(k));
    const BorderedMatrix all = with(whole, C, beam.system.driven_nodes());
    ZeroRowSumMatrix* A = mixed(*solver).step_matrix(beam.pattern());
    ASSERT_NE(A, nullptr);
    beam.at(0.2 * k, kStep, *A, b);
    A->points = C;
    ASSERT_EQ(direct->factor(all), SolveStatus::kOk);
    ASSERT_EQ(direct->solve(b, exact), SolveStatus::kOk);
    ASSERT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kRefine) << k;
    Known left(all, b);
    ASSERT_EQ(mixed(*solver).solve_by_refinement(left, x), SolveStatus::kOk) << k;
    EXPECT_LE(energy_norm(all, x - exact), kTolerance * energy_norm(all, exact)) << k;
  }
  EXPECT_EQ(solver->counters().symbolic, 1);
  EXPECT_EQ(solver->counters().factorisations, 4);
}

// A node in contact that is held along one axis moves along the other two only.
TEST_P(PointSolvers, NodesMayBeHeldAlongOneAxis) {
  constexpr double kStep = 1e-2;
  BentBeam beam(8, 1e5);
  BorderedMatrix whole;
  VecX b, x, exact;
  beam.at(0.5, kStep, whole, b);
  const PointStiffness C = random_points(whole.body.block_rows(), 30, 20.0, 3);
  BorderedMatrix all = with(whole, C, beam.system.driven_nodes());
  std::vector<HeldNode> held = beam.system.driven_nodes();
  std::vector<int> dofs;
  const auto hold = [&](const PointStiffness::Nodes& nodes) {
    for (int i = 0; i < nodes.count; ++i) {
      const int node = nodes.node[static_cast<std::size_t>(i)];
      if (std::any_of(held.begin(), held.end(), [&](const HeldNode& h) { return h.node == node; })) continue;
      held.push_back({node, {true, false, false}});
      dofs.push_back(3 * node);
    }
  };
  for (std::size_t k = 0; k < 13; ++k) hold(C.points[k].nodes);
  ASSERT_GT(dofs.size(), 12u);
  const auto is_held = [&](int dof) { return std::find(dofs.begin(), dofs.end(), dof) != dofs.end(); };
  for (int i = 0; i < all.body.block_rows(); ++i)
    for (int s = all.body.row_start()[static_cast<std::size_t>(i)];
         s < all.body.row_start()[static_cast<std::size_t>(i) + 1]; ++s) {
      const int j = all.body.columns()[static_cast<std::size_t>(s)];
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          if (is_held(3 * i + r) || is_held(3 * j + c))
            all.body.block(s)[3 * r + c] = i == j && r == c ? 1.0 : 0.0;
    }
  all.touch();
  const auto solver = linear::make_linear_solver(GetParam(), {.step_s = kStep, .linear_rtol = 1e-4});
  const auto direct = linear::make_linear_solver("cholmod");
  ZeroRowSumMatrix* A = mixed(*solver).step_matrix(beam.pattern());
  ASSERT_NE(A, nullptr);
  beam.at(0.5, kStep, *A, b);
  A->points = C;
  A->held = &held;
  for (const int dof : dofs) b[dof] = 0.0;
  ASSERT_EQ(direct->factor(all), SolveStatus::kOk);
  ASSERT_EQ(direct->solve(b, exact), SolveStatus::kOk);
  ASSERT_EQ(mixed(*solver).factor_step_matrix(), StepMatrixUse::kSolve);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  EXPECT_LE(energy_norm(all, x - exact), 1e-4 * energy_norm(all, exact));
  for (const int dof : dofs) EXPECT_EQ(x[dof], 0.0);
}

}  // namespace palpate
