#pragma once
#include <vector>

#include "core/team.h"
#include "linear/mixed_precision/node_order.h"

namespace palpate::linear {

/// Thread team over the parts of a NodeOrder; each thread works on a fixed range of parts. Sums are formed
/// per part or per cluster and then in their order, so results do not depend on the number of threads.
class ClusterTeam {
 public:
  explicit ClusterTeam(int threads) : team_(threads) {}
  int size() const { return team_.size(); }

  /// Distributes the parts over the threads, balanced by the number of blocks as far as whole parts allow.
  /// @param row_start  First block of each row, in the order's numbering.
  void share(const NodeOrder& order, const std::vector<int>& row_start);
  /// Calls work(thread) on each thread.
  template <class Work>
  void run(Work&& work) {
    team_.run(work);
  }
  /// Waits for all threads; inside run() only.
  void barrier() { team_.barrier(); }
  /// Calls work(part, first node, last node) for each part of a thread. Call inside run().
  template <class Work>
  void over(int thread, Work&& work) const {
    for (auto p = static_cast<std::size_t>(mine_[static_cast<std::size_t>(thread)]);
         p < static_cast<std::size_t>(mine_[static_cast<std::size_t>(thread) + 1]); ++p)
      work(p, order_->first_node(p), order_->first_node(p + 1));
  }
  /// Calls work(cluster, first node, last node) for each cluster of a thread's parts. Call inside run().
  template <class Work>
  void over_clusters(int thread, Work&& work) const {
    const auto cluster = [&](int t) {
      return static_cast<std::size_t>(
          order_->part[static_cast<std::size_t>(mine_[static_cast<std::size_t>(t)])]);
    };
    for (std::size_t c = cluster(thread); c < cluster(thread + 1); ++c)
      work(c, order_->start[c], order_->start[c + 1]);
  }
  /// Calls work(part, first node, last node) for all parts, on all threads.
  template <class Work>
  void for_each(Work&& work) {
    team_.run([&](int thread) { over(thread, work); });
  }

 private:
  Team team_;
  const NodeOrder* order_ = nullptr;
  std::vector<int> mine_;  ///< first part of each thread; threads + 1 entries
};

}  // namespace palpate::linear
