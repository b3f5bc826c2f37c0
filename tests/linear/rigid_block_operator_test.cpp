// Rigid blocks beside the sparsity pattern of a matrix.
#include <gtest/gtest.h>

#include "linear/mixed_precision/point_operator.h"
#include "linear/random_points.h"
#include "palpate/dynamics/sparse_border.h"

namespace palpate {
namespace {

using namespace dynamics;

// With rigid blocks the operator is C - B S^-1 B^T of the symmetric part of their border, in products and in
// the diagonal blocks.
TEST(PointOperator, EliminatesRigidBlocks) {
  constexpr int kNodes = 40, kBorder = 12, kSize = 3 * kNodes + kBorder;
  constexpr double kScale = 0.25;
  const Order order(kNodes);
  const PointStiffness C = random_points(kNodes, 12, 3.0, 5);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  SparseBorder border;
  MatX whole = MatX::Zero(kSize, kSize);
  for_each_block(C, [&](int i, int j, const Mat3& block) { whole.block<3, 3>(3 * i, 3 * j) += block; });
  for (int turn = 0; turn < 2; ++turn) {  // a border that is used again leaves no trace
    border.reset(kNodes, kBorder);
    for (const auto& one : C.points) {
      SparseBorder::Entry& entry = border.at(one.nodes.node[1], uniform(random) > 0.0 ? 6 : 0);
      for (double& value : entry.right.reshaped()) value += uniform(random);
      for (double& value : entry.bottom.reshaped()) value += uniform(random);
    }
    for (double& value : border.corner.reshaped()) value = uniform(random);
    border.corner.diagonal().array() += 20.0;
  }
  for (const SparseBorder::Entry& entry : border.entries()) {
    whole.block<3, 6>(3 * entry.node, 3 * kNodes + entry.column) += entry.right;
    whole.block<6, 3>(3 * kNodes + entry.column, 3 * entry.node) += entry.bottom;
  }
  whole.bottomRightCorner<kBorder, kBorder>() = border.corner;
  const VecX u = VecX::NullaryExpr(kSize, [&] { return uniform(random); });
  VecX by_parts = VecX::Zero(kSize), of_border = border.corner * u.tail(kBorder);
  C.add_product(u, 1.0, by_parts);
  border.add_right_product(u, 1.0, by_parts);
  border.add_bottom_product(u, 1.0, of_border);
  by_parts.tail(kBorder) = of_border;
  EXPECT_LT((by_parts - whole * u).norm(), 1e-13 * (whole * u).norm());

  whole = (0.5 * (whole + whole.transpose())).eval();
  const MatX B = whole.topRightCorner(3 * kNodes, kBorder), S = whole.bottomRightCorner(kBorder, kBorder);
  const MatX expected = whole.topLeftCorner(3 * kNodes, 3 * kNodes) - B * S.inverse() * B.transpose();
  linear::PointOperator op;
  ASSERT_TRUE(op.take(C, border, order.place, order.order, kScale));
  std::vector<double> x(4 * kNodes, 0.0), y(4 * kNodes, 0.0);
  const auto place = [&](int node) { return 4 * order.place[static_cast<std::size_t>(node)]; };
  for (int i = 0; i < kNodes; ++i) Eigen::Map<Vec3>(x.data() + place(i)) = u.segment<3>(3 * i);
  const std::vector<float> p(x.begin(), x.end());
  std::vector<float> q(4 * kNodes, 0.0f);
  double share = 0.0;
  for (const std::size_t part : {0u, 1u}) {
    op.product(part, x.data(), y.data());
    share += op.product(part, p.data(), q.data());
  }
  const VecX result = expected * u.head(3 * kNodes);
  for (int i = 0; i < kNodes; ++i) {
    EXPECT_LT((Eigen::Map<Vec3>(y.data() + place(i)) - result.segment<3>(3 * i)).norm(), 1e-12);
    EXPECT_LT(
        (Eigen::Map<Eigen::Vector3f>(q.data() + place(i)).cast<double>() - kScale * result.segment<3>(3 * i))
            .norm(),
        1e-5);
  }
  EXPECT_NEAR(share, kScale * u.head(3 * kNodes).dot(result), 1e-4);
  for (const auto& own : op.diagonal()) {
    const int node = order.order.node[static_cast<std::size_t>(own.node)];
    EXPECT_LT((own.block.cast<double>() - kScale * expected.block<3, 3>(3 * node, 3 * node)).norm(), 1e-5);
  }
  border.corner(3, 3) = -20.0;
  EXPECT_FALSE(op.take(C, border, order.place, order.order, kScale)) << "S is indefinite";
}

}  // namespace
}  // namespace palpate
