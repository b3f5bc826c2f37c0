#pragma once
#include <vector>

#include "integrate/linear/node_order.h"
#include "palpate/core/team.h"

namespace palpate::integrate {

/// Threads that work on the clusters of an order, each on its own ones.  Sums go over clusters, in their order: results do not depend on the number of threads.
class ClusterTeam {
 public:
  explicit ClusterTeam(int threads) : team_(threads) {}
  int size() const { return team_.size(); }

  /// Shares the clusters out by numbers of blocks, as nearly equal as clusters allow.
  void share(const NodeOrder& order, const std::vector<int>& row_start);
  /// work(thread) on each thread.
  template <class Work>
  void run(Work&& work) { team_.run(work); }
  void barrier() { team_.barrier(); }
  /// Inside run: work(cluster, first node, last node) over the clusters of a thread.
  template <class Work>
  void over(int thread, Work&& work) const {
    for (int c = mine_[static_cast<std::size_t>(thread)]; c < mine_[static_cast<std::size_t>(thread) + 1]; ++c)
      work(static_cast<std::size_t>(c), order_->start[static_cast<std::size_t>(c)], order_->start[static_cast<std::size_t>(c) + 1]);
  }
  /// All clusters, on all threads.
  template <class Work>
  void for_each(Work&& work) {
    team_.run([&](int thread) { over(thread, work); });
  }

 private:
  Team team_;
  const NodeOrder* order_ = nullptr;
  std::vector<int> mine_;  ///< first cluster of each thread
};

}  // namespace palpate::integrate
