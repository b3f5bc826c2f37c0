#include "palpate/dynamics/matrix.h"

#include <gtest/gtest.h>

#include <random>

#include "palpate/core/error.h"

using namespace palpate;
using namespace palpate::dynamics;

namespace {

BlockSparse chain(int nodes) {
  PatternBuilder builder(nodes);
  for (int i = 0; i + 1 < nodes; ++i) builder.add_pair(i, i + 1);
  return builder.build();
}

TEST(PatternBuilder, SortsDeduplicatesAndKeepsTheDiagonal) {
  PatternBuilder builder(4);
  const int clique[3] = {3, 0, 1};
  builder.add_clique(clique, 3);
  builder.add_pair(0, 1);
  const BlockSparse m = builder.build();
  EXPECT_EQ(m.row_start(), (std::vector<int>{0, 3, 6, 7, 10}));
  EXPECT_EQ(m.columns(), (std::vector<int>{0, 1, 3, 0, 1, 3, 2, 0, 1, 3}));
  EXPECT_EQ(m.slot(2, 2), 6);
  EXPECT_EQ(m.slot(2, 3), -1);
  EXPECT_THROW(builder.add_pair(0, 4), InternalError);
}

TEST(NodePairs, SortAsTheStandardLibraryDoes) {
  std::mt19937 random(5);
  for (const int nodes : {1, 2, 7, 200}) {
    std::uniform_int_distribution<int> node(0, nodes - 1);
    NodePairs pairs;
    for (int i = 0; i < 500; ++i) pairs.emplace_back(node(random), node(random));
    NodePairs expected = pairs;
    std::sort(expected.begin(), expected.end());
    expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
    sort_unique(pairs, nodes);
    EXPECT_EQ(pairs, expected) << nodes << " nodes";
  }
  NodePairs none;
  sort_unique(none, 0);
  EXPECT_TRUE(none.empty());
}

TEST(PatternBuilder, ListsTogetherAreOneThatWasToldAll) {
  std::mt19937 random(2);
  std::uniform_int_distribution<int> node(0, 19);
  PatternBuilder all(20), parts[3] = {PatternBuilder(20), PatternBuilder(20), PatternBuilder(20)};
  for (int i = 0; i < 90; ++i) {
    const int a = node(random), b = node(random);
    all.add_pair(a, b);
    parts[i % 3].add_pair(a, b);
    if (i % 7 == 0) parts[(i + 1) % 3].add_pair(a, b);
  }
  const NodePairs lists[] = {parts[0].pairs(), {}, parts[1].pairs(), parts[2].pairs()};
  const BlockSparse one = all.build(), other = pattern_of(20, {&lists[0], &lists[1], &lists[2], &lists[3]});
  EXPECT_EQ(one.row_start(), other.row_start());
  EXPECT_EQ(one.columns(), other.columns());
  for (int i = 0; i < 20; ++i) EXPECT_EQ(one.diagonal(i), other.diagonal(i));
  EXPECT_EQ(other.values(), std::vector<double>(9 * static_cast<std::size_t>(other.slot_count()), 0.0));
}

TEST(BlockSparse, EveryPatternHasAVersionOfItsOwn) {
  EXPECT_NE(chain(3).pattern_version(), chain(3).pattern_version());
}

TEST(BorderedMatrix, ProductAgreesWithTheDenseMatrix) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  BorderedMatrix A;
  A.body = chain(5);
  for (double& v : A.body.values()) v = normal(random);
  A.right = MatX::NullaryExpr(15, 6, [&] { return normal(random); });
  A.bottom = MatX::NullaryExpr(6, 15, [&] { return normal(random); });
  A.corner = MatX::NullaryExpr(6, 6, [&] { return normal(random); });
  const VecX x = VecX::NullaryExpr(21, [&] { return normal(random); });
  VecX y;
  A.multiply(x, y);
  EXPECT_LT((y - A.to_dense() * x).norm(), 1e-13);
  VecX transposed = VecX::Zero(15);
  A.body.multiply_transposed_add(x.data(), transposed.data());
  EXPECT_LT((transposed - A.to_dense().topLeftCorner(15, 15).transpose() * x.head(15)).norm(), 1e-13);
  EXPECT_THROW(A.multiply(x.head(20), y), InternalError);
}

}  // namespace
