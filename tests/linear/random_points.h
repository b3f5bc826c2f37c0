#pragma once
#include <array>
#include <random>
#include <utility>
#include <vector>

#include "linear/mixed_precision/node_order.h"
#include "palpate/dynamics/point_stiffness.h"

/// Sums outside of a sparsity pattern, and an order of the nodes, for tests of the operator that applies
/// them.
namespace palpate {

/// Random sums of every kind between any nodes, with magnitude `size` [kg].
inline dynamics::PointStiffness random_points(int nodes, int count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::uniform_int_distribution<int> any(0, nodes - 1);
  dynamics::PointStiffness out;
  for (int k = 0; k < count; ++k) {
    dynamics::PointStiffness::Nodes of;
    of.relative = k % 2 == 0;
    of.count = of.relative ? 8 : 3 + k % 2;
    for (int i = 0; i < of.count; ++i) of.node[static_cast<std::size_t>(i)] = any(random);
    const auto weights = [&] {  // a's weights sum to 1, b's to -1
      dynamics::PointStiffness::Weights w = dynamics::PointStiffness::Weights::Zero();
      for (int i = 0; i < of.count; ++i) w[i] = 0.3 + 0.2 * uniform(random);
      const int a = of.relative ? 4 : of.count;
      w.head(a) /= w.head(a).sum();
      if (of.relative) w.tail(4) /= -w.tail(4).sum();
      return w;
    };
    const Vec3 n = Vec3(uniform(random), uniform(random), uniform(random)).normalized();
    const Mat3 C = n * n.transpose() + (k % 3 == 0 ? 0.1 : 0.0) * Mat3::Identity();
    for (int s = 0; s < (k % 3 == 0 ? 1 : 5); ++s) out.points.push_back({of, weights(), 0.2 * size * C});
  }
  return out;
}

/// Calls visit(i, j, block) for each block of the definition.
template <class Visit>
void for_each_block(const dynamics::PointStiffness& C, Visit visit) {
  for (const auto& a : C.points)
    for (int i = 0; i < a.nodes.count; ++i)
      for (int j = 0; j < a.nodes.count; ++j)
        visit(a.nodes.node[static_cast<std::size_t>(i)], a.nodes.node[static_cast<std::size_t>(j)],
              Mat3(a.weight[i] * a.weight[j] * a.C));
}

/// Two parts, with nodes in a permuted order.
struct Order {
  linear::NodeOrder order;
  std::vector<int> place;
  explicit Order(int nodes) : place(static_cast<std::size_t>(nodes)) {
    for (int k = 0; k < nodes; ++k) {
      order.node.push_back((7 * k + 3) % nodes);
      place[static_cast<std::size_t>(order.node.back())] = k;
    }
    order.start = {0, nodes / 3, nodes};
    order.part = {0, 1, 2};
    order.piece_start = order.start;
    order.piece = {0, 1, 2};
  }
};

}  // namespace palpate
