#include "linear/mixed_precision/cluster_team.h"

namespace palpate::linear {

void ClusterTeam::share(const NodeOrder& order, const std::vector<int>& row_start) {
  order_ = &order;
  const int threads = size();
  mine_.assign(static_cast<std::size_t>(threads) + 1, 0);
  int part = 0;
  for (int t = 1; t <= threads; ++t) {
    const long goal = static_cast<long>(row_start.back()) * t / threads;
    while (part < order.parts() &&
           row_start[static_cast<std::size_t>(order.first_node(static_cast<std::size_t>(part) + 1))] <= goal)
      ++part;
    mine_[static_cast<std::size_t>(t)] = t == threads ? order.parts() : part;
  }
}

}  // namespace palpate::linear
