#pragma once
#include "linear/mixed_precision/node_order.h"
#include "palpate/core/workers.h"

namespace palpate::linear {

/// Threads that share loops over the parts of a NodeOrder. A part is a task, and each thread begins at its
/// own end of the parts. Sums are formed per part or per cluster and then in their order, so results do not
/// depend on the number of threads.
class ClusterTeam {
 public:
  /// @param threads  number of threads, including the calling one
  explicit ClusterTeam(int threads) : threads_(threads) {}

  /// Sets the order whose parts are shared; it must outlive this object.
  void share(const NodeOrder& order) { order_ = &order; }
  /// Calls work(part, first node, last node) for all parts.
  template <class Work>
  void for_each(Work&& work) const {
    run([&](std::size_t p) { work(p, order_->first_node(p), order_->first_node(p + 1)); });
  }
  /// Calls work(cluster, first node, last node) for the clusters of all parts.
  template <class Work>
  void for_each_cluster(Work&& work) const {
    run([&](std::size_t p) {
      for (auto c = static_cast<std::size_t>(order_->part[p]);
           c < static_cast<std::size_t>(order_->part[p + 1]); ++c)
        work(c, order_->start[c], order_->start[c + 1]);
    });
  }
  /// Calls work(first, last) for consecutive ranges that together are [0, count), as many as there are parts.
  template <class Work>
  void for_each_range(int count, Work&& work) const {
    const int parts = order_->parts();
    run([&](std::size_t p) {
      const int k = static_cast<int>(p);
      work(count * k / parts, count * (k + 1) / parts);
    });
  }

 private:
  template <class Work>
  void run(Work&& work) const {
    const workers::Count count(threads_);
    workers::for_each(
        order_->parts(), [&](int part, int) { work(static_cast<std::size_t>(part)); },
        workers::Order::kFromBothEnds);
  }

  int threads_;
  const NodeOrder* order_ = nullptr;
};

}  // namespace palpate::linear
