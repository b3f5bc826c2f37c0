#pragma once
#include <vector>

#include "linear/mixed_precision/node_order.h"
#include "palpate/core/team.h"

namespace palpate::linear {

/// Threads that work on the parts of an order, each on its own ones.  Sums go over parts or clusters, in
/// their order: results do not depend on the number of threads.
class ClusterTeam {
 public:
  explicit ClusterTeam(int threads) : team_(threads) {}
  int size() const { return team_.size(); }

  /// Shares the parts out by numbers of blocks, as nearly equal as parts allow.
  void share(const NodeOrder& order, const std::vector<int>& row_start);
  /// work(thread) on each thread.
  template <class Work>
  void run(Work&& work) {
    team_.run(work);
  }
  void barrier() { team_.barrier(); }
  /// Inside run: work(part, first node, last node) over the parts of a thread.
  template <class Work>
  void over(int thread, Work&& work) const {
    for (auto p = static_cast<std::size_t>(mine_[static_cast<std::size_t>(thread)]);
         p < static_cast<std::size_t>(mine_[static_cast<std::size_t>(thread) + 1]); ++p)
      work(p, order_->first_node(p), order_->first_node(p + 1));
  }
  /// Inside run: work(cluster, first node, last node) over the clusters of these parts.
  template <class Work>
  void over_clusters(int thread, Work&& work) const {
    const auto cluster = [&](int t) {
      return static_cast<std::size_t>(
          order_->part[static_cast<std::size_t>(mine_[static_cast<std::size_t>(t)])]);
    };
    for (std::size_t c = cluster(thread); c < cluster(thread + 1); ++c)
      work(c, order_->start[c], order_->start[c + 1]);
  }
  /// All parts, on all threads.
  template <class Work>
  void for_each(Work&& work) {
    team_.run([&](int thread) { over(thread, work); });
  }

 private:
  Team team_;
  const NodeOrder* order_ = nullptr;
  std::vector<int> mine_;  ///< first part of each thread
};

}  // namespace palpate::linear
