#include "linear/mixed_precision/rigid_mode_coarse_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "linear/mixed_precision/single_iteration.h"
#include "palpate/dynamics/matrix.h"

namespace palpate {
namespace {

using dynamics::BorderedMatrix;

/// Springs along the edges and diagonals of a lattice of unit cells, each with a transverse part, and a mass:
/// positive definite, insensitive to translations except for the mass.
struct SpringBlock {
  int along, across;
  Points positions;
  BorderedMatrix A;

  explicit SpringBlock(int cells_along, int cells_across, double mass)
      : along(cells_along + 1), across(cells_across + 1) {
    positions.resize(3, along * across * across);
    for (int i = 0; i < positions.cols(); ++i)
      positions.col(i) = Vec3(i / (across * across), i / across % across, i % across);
    dynamics::PatternBuilder pattern(static_cast<int>(positions.cols()));
    const auto each = [&](auto&& act) {
      for (int i = 0; i < positions.cols(); ++i)
        for (int j = 0; j < i; ++j)
          if ((positions.col(i) - positions.col(j)).squaredNorm() < 2.5) act(i, j);
    };
    each([&](int i, int j) { pattern.add_pair(i, j); });
    A.body = pattern.build();
    for (int i = 0; i < positions.cols(); ++i)
      A.body.add(A.body.slot(i, i), mass * (1.0 + 0.1 * (i % 3)) * Mat3::Identity());
    each([&](int i, int j) {
      const Vec3 d = (positions.col(i) - positions.col(j)).normalized();
      const Mat3 k = d * d.transpose() + 0.05 * Mat3::Identity();
      for (const auto& [row, column, sign] : {std::tuple{i, i, 1.0}, {j, j, 1.0}, {i, j, -1.0}, {j, i, -1.0}})
        A.body.add(A.body.slot(row, column), sign * k);
    });
    A.touch();
  }
  int nodes() const { return static_cast<int>(positions.cols()); }
  MatX dense() const {
    MatX full = MatX::Zero(3 * nodes(), 3 * nodes());
    VecX unit = VecX::Zero(3 * nodes()), image;
    for (int k = 0; k < 3 * nodes(); ++k) {
      unit[k] = 1.0;
      A.multiply(unit, image);
      full.col(k) = image;
      unit[k] = 0.0;
    }
    return full;
  }
};

/// The solver's components around one matrix.
struct Preconditioner {
  const linear::NodeKernels& kernels = linear::node_kernels();
  linear::ClusterTeam team;
  linear::SingleMatrix matrix{kernels, team};
  linear::RigidModeCoarseSpace clusters;
  linear::SingleIteration iteration{kernels, team, matrix, clusters};

  Preconditioner(const SpringBlock& block, int count, int parts, int pieces, int threads = 1,
                 bool with_positions = true)
      : team(threads) {
    matrix.analyse(block.A.body, {count, parts, pieces});
    clusters.prepare(matrix.order());
    iteration.prepare();
    EXPECT_EQ(matrix.take(block.A, 0, nullptr, nullptr), dynamics::SolveStatus::kOk);
    EXPECT_TRUE(clusters.refresh(matrix, with_positions ? block.positions.data() : nullptr, kernels));
  }
  /// r . P^-1 r of the scaled copy, in units of the matrix.
  double form(const VecX& r) {
    for (int k = 0; k < matrix.nodes(); ++k)
      for (int axis = 0; axis < 3; ++axis)
        iteration.residual()[static_cast<std::size_t>(4 * k + axis)] =
            static_cast<float>(r[3 * matrix.order().node[static_cast<std::size_t>(k)] + axis]);
    return iteration.precondition([](int, int) {}) * matrix.scale();
  }
};

/// Rigid motions of ranges of nodes, with a unit of length as the scale of rotations: the projection onto a
/// space does not depend on units.
MatX rigid_motions(const SpringBlock& block, const linear::NodeOrder& order, const std::vector<int>& start) {
  MatX Z = MatX::Zero(3 * block.nodes(), 6 * static_cast<Eigen::Index>(start.size() - 1));
  for (std::size_t c = 0; c + 1 < start.size(); ++c)
    for (int k = start[c]; k < start[c + 1]; ++k) {
      const int i = order.node[static_cast<std::size_t>(k)];
      const Vec3 x =
          block.positions.col(i) - block.positions.col(order.node[static_cast<std::size_t>(start[c])]);
      const auto column = 6 * static_cast<Eigen::Index>(c);
      Z.block<3, 3>(3 * i, column).setIdentity();
      for (int axis = 0; axis < 3; ++axis)
        Z.block<3, 1>(3 * i, column + 3 + axis) = Vec3::Unit(axis).cross(x);
    }
  return Z;
}

/// J^-1 + Y D^-1 Y^T + Z E^-1 Z^T, as in rigid_mode_coarse_space.h.
MatX by_definition(const SpringBlock& block, const linear::NodeOrder& order, bool with_pieces) {
  const MatX A = block.dense(), Z = rigid_motions(block, order, order.start),
             Y = rigid_motions(block, order, order.piece_start);
  MatX P = Z * (Z.transpose() * A * Z).inverse() * Z.transpose();
  for (int i = 0; i < block.nodes(); ++i)
    P.block<3, 3>(3 * i, 3 * i) += Mat3(A.block<3, 3>(3 * i, 3 * i)).inverse();
  const MatX D = Y.transpose() * A * Y;
  for (Eigen::Index p = 0; with_pieces && p < D.rows(); p += 6) {
    const MatX own = Y.middleCols(p, 6);
    P += own * MatX(D.block(p, p, 6, 6)).inverse() * own.transpose();
  }
  return P;
}

VecX noise(int size, int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> normal;
  VecX v(size);
  for (double& value : v) value = normal(random);
  return v;
}

TEST(RigidModeCoarseSpace, PreconditionByBlocksPiecesAndClustersAsDefined) {
  const SpringBlock block(11, 3, 0.05);
  for (const auto& [count, pieces] : {std::pair{3, 12}, {2, 5}, {4, 0}}) {
    Preconditioner by(block, count, 1, pieces);
    ASSERT_EQ(by.matrix.order().pieces(), std::max(count, pieces));
    const MatX P = by_definition(block, by.matrix.order(), pieces > count);
    for (int seed = 1; seed <= 4; ++seed) {
      const VecX r = noise(3 * block.nodes(), seed);
      // E's diagonal is increased by 1e-5 against rounding
      EXPECT_NEAR(by.form(r) / r.dot(P * r), 1.0, 1e-4) << count << " clusters, " << pieces << " pieces";
    }
    for (Eigen::Index c = 0; c < 6; ++c) {  // forces that move one cluster as a whole
      const VecX r = rigid_motions(block, by.matrix.order(), by.matrix.order().start).col(c);
      EXPECT_NEAR(by.form(r) / r.dot(P * r), 1.0, 1e-3);
    }
  }
}

TEST(RigidModeCoarseSpace, WithoutPositionsTheyTranslate) {
  const SpringBlock block(5, 2, 0.05);
  Preconditioner by(block, 2, 1, 6, 1, false);
  const VecX r = noise(3 * block.nodes(), 1);
  const double translated = by.form(r);
  Preconditioner turning(block, 2, 1, 6);
  EXPECT_GT(translated, 0.0);
  EXPECT_LT(translated, turning.form(r)) << "fewer directions take less";
}

TEST(RigidModeCoarseSpace, GiveTheSameOnOneAndTwoThreads) {
  const SpringBlock block(12, 3, 0.05);
  const VecX r = noise(3 * block.nodes(), 3);
  Preconditioner one(block, 8, 4, 20), two(block, 8, 4, 20, 2);
  EXPECT_EQ(one.form(r), two.form(r));
}

// Purpose of pieces: few large clusters leave variations within them to the diagonal blocks, on a bar with l
// cells per cluster with a condition number of order l^2. Pieces of p cells form a chain of l/p, and
// represent a smooth motion in steps of a piece, which has p times its energy (all of it in one of p cells):
// p (l/p)^2, a p-th of l^2. The largest eigenvalue is at most the number of levels: three instead of two.
TEST(RigidModeCoarseSpace, PiecesBoundTheConditionWhereClustersAreLarge) {
  const SpringBlock block(63, 1, 1e-6);
  const auto condition = [&](int pieces) {
    Preconditioner by(block, 2, 1, pieces);
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> eigen(
        block.dense(), by_definition(block, by.matrix.order(), pieces > 2).inverse(), Eigen::EigenvaluesOnly);
    return eigen.eigenvalues().maxCoeff() / eigen.eigenvalues().minCoeff();
  };
  const double large = condition(0), small = condition(16);
  EXPECT_LT(small, 3.0 / 2.0 / 4.0 * large) << large;
}

TEST(NodeOrder, CutsClustersIntoPieces) {
  const SpringBlock block(15, 4, 1.0);
  for (const auto& [clusters, parts, pieces] : {std::tuple{7, 3, 20}, {4, 4, 4}, {5, 1, 0}}) {
    const linear::NodeOrder order = linear::cluster_nodes(block.A.body, clusters, parts, pieces);
    EXPECT_EQ(order.clusters(), clusters);
    EXPECT_EQ(order.pieces(), std::clamp(pieces, clusters, block.nodes()));
    ASSERT_EQ(order.piece.size(), static_cast<std::size_t>(clusters) + 1);
    for (std::size_t c = 0; c <= static_cast<std::size_t>(clusters); ++c)
      EXPECT_EQ(order.piece_start[static_cast<std::size_t>(order.piece[c])], order.start[c])
          << "pieces end where clusters do";
    const auto most = [](int count, int of) { return (count + of - 1) / of; };
    for (std::size_t p = 0; p + 1 < order.piece_start.size(); ++p) {  // a share is the quotient or one more
      const int size = order.piece_start[p + 1] - order.piece_start[p];
      EXPECT_GE(size, block.nodes() / (parts * most(clusters, parts) * most(order.pieces(), clusters)) - 1);
      EXPECT_LE(size, block.nodes() / (parts * (clusters / parts) * (order.pieces() / clusters)) + 1);
    }
    std::vector<int> seen = order.node;
    std::sort(seen.begin(), seen.end());
    for (int i = 0; i < block.nodes(); ++i) ASSERT_EQ(seen[static_cast<std::size_t>(i)], i);
  }
  // a cluster has no more pieces than nodes
  const linear::NodeOrder finest = linear::cluster_nodes(block.A.body, 3, 2, 10 * block.nodes());
  EXPECT_LE(finest.pieces(), block.nodes());
  for (std::size_t p = 0; p + 1 < finest.piece_start.size(); ++p)
    EXPECT_LT(finest.piece_start[p], finest.piece_start[p + 1]) << "none is empty";
}

}  // namespace
}  // namespace palpate
