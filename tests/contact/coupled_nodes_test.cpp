// Coupling blocks between the nodes of two bodies: added when contact occurs, for nearby nodes as well, and
// reset when they become too many.
#include "contact/coupled_nodes.h"

#include <gtest/gtest.h>

#include <set>

using namespace palpate;
using namespace palpate::contact;

namespace {

constexpr int kNodes = 40, kFirst = 100;  // each body is a chain of edges; b's nodes are numbered from kFirst

NodeNeighbours chain(int first) {
  Eigen::MatrixXi edges(2, kNodes - 1);
  for (int i = 0; i + 1 < kNodes; ++i) edges.col(i) = Eigen::Vector2i(i, i + 1);
  return {edges, first};
}

/// Joint between the same node of either chain.
std::vector<CoupledNodes::Joint> joint_at(int node) {
  CarriedPoint a, b;
  a.number = b.number = node;
  a.point.count = b.point.count = 1;
  a.point.node[0] = node;
  b.point.node[0] = kFirst + node;
  return {CoupledNodes::joint_of(a, b)};
}

std::set<std::pair<int, int>> pairs_of(CoupledNodes& coupled) {
  dynamics::PatternBuilder pattern(kFirst + kNodes);
  coupled.add_pattern(pattern);
  std::set<std::pair<int, int>> out;
  for (const auto& [i, j] : pattern.pairs())
    if (i < kFirst && j >= kFirst) out.emplace(i, j - kFirst);
  return out;
}

}  // namespace

TEST(NodeNeighbours, AreThoseOfTheElements) {
  const NodeNeighbours near = chain(7);
  const auto of = [&](int node) { return std::vector<int>(near.of(node).begin(), near.of(node).end()); };
  EXPECT_EQ(of(7), (std::vector<int>{7, 8}));
  EXPECT_EQ(of(17), (std::vector<int>{16, 17, 18}));
}

TEST(CoupledNodes, WaitForContactThatSlidesByAnElement) {
  const NodeNeighbours a = chain(0), b = chain(kFirst);
  CoupledNodes coupled;
  coupled.start(a, b);
  coupled.take(joint_at(10));
  EXPECT_EQ(pairs_of(coupled).size(), 9u) << "each of three with each of three";
  const auto version = coupled.version();
  for (const int node : {9, 11, 10}) {
    coupled.take(joint_at(node));
    EXPECT_EQ(coupled.version(), version);
  }
  coupled.take(joint_at(12));
  EXPECT_GT(coupled.version(), version);
  EXPECT_TRUE(pairs_of(coupled).contains({9, 9})) << "what was met stays for a while";
  EXPECT_TRUE(pairs_of(coupled).contains({13, 13}));
  EXPECT_TRUE(pairs_of(coupled).contains({12, 12}));
}

TEST(CoupledNodes, StartAnewWhereMostIsPast) {
  const NodeNeighbours a = chain(0), b = chain(kFirst);
  CoupledNodes coupled;
  coupled.start(a, b);
  for (int node = 2; node < 36; node += 3)
    for (int again = 0; again < 2; ++again) {
      coupled.take(joint_at(node));
      coupled.version();
    }
  EXPECT_LE(pairs_of(coupled).size(), 18u);
  EXPECT_TRUE(pairs_of(coupled).contains({35, 35}));
  EXPECT_FALSE(pairs_of(coupled).contains({2, 2}));
  coupled.take(joint_at(2));
  EXPECT_TRUE(pairs_of(coupled).contains({2, 2})) << "was known, and forgotten";
  const auto version = coupled.version();
  coupled.start(a, b);
  EXPECT_TRUE(pairs_of(coupled).empty());
  EXPECT_GT(coupled.version(), version);
}

TEST(CoupledNodes, AreMadeOfTheLastQueryWhenSomebodyAsks) {
  const NodeNeighbours a = chain(0), b = chain(kFirst);
  CoupledNodes coupled;
  coupled.start(a, b);
  for (const int node : {5, 10, 30}) coupled.take(joint_at(node));
  EXPECT_EQ(pairs_of(coupled).size(), 9u) << "nobody asked for the first two";
  EXPECT_TRUE(pairs_of(coupled).contains({30, 30}));
  const auto version = coupled.version();
  EXPECT_GT(version, 0u);
  coupled.take(joint_at(12));
  EXPECT_GT(coupled.version(), version) << "the version alone is an answer, too";
}
