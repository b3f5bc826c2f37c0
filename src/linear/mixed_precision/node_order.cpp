#include "linear/mixed_precision/node_order.h"

#include <algorithm>

namespace palpate::linear {
namespace {

/// Nodes per cluster, and most clusters: E^-1 is dense, with (6 clusters)^2 numbers to be read per iteration
/// and (6 clusters)^3 operations per refresh.
constexpr int kNodesOfCluster = 150, kMostClusters = 48;
/// Nodes per piece. The number of iterations hardly changes from 16 to 64; with pieces, 48 clusters need as
/// many iterations as 96 (beams of 32,400 and 99,238 nodes).
constexpr int kNodesOfPiece = 32;
/// Most nodes per part: its share of vectors and of the matrix fits a second-level cache, and few pairs of
/// nodes are cut. The number of parts is a multiple of four, for threads to share; very small matrices have
/// one part.
constexpr int kNodesOfPart = 3072, kNodesOfOnePart = 512;
int parts_of(int nodes) {
  return nodes <= kNodesOfOnePart ? 1 : 4 * ((nodes + 4 * kNodesOfPart - 1) / (4 * kNodesOfPart));
}

/// Recursive bisection of a NodeOrder along breadth-first levels.
class Bisection {
 public:
  Bisection(const dynamics::BlockSparse& A, NodeOrder& order)
      : A_(A), order_(order), part_(order.node.size(), 0) {}

  /// Divides nodes [first, last) of the order into `count` sets and appends their ends.
  void cut(int first, int last, int count, std::vector<int>& ends) {
    if (count == 1) {
      ends.push_back(last);
      return;
    }
    breadth_first(first, last, order_.node[static_cast<std::size_t>(first)]);
    // the node reached last is peripheral
    breadth_first(first, last, order_.node[static_cast<std::size_t>(last) - 1]);
    const int left = count / 2,
              middle = first + static_cast<int>(static_cast<long>(last - first) * left / count);
    ++parts_;
    for (int k = first; k < middle; ++k) part_[node(k)] = parts_;
    ++parts_;
    for (int k = middle; k < last; ++k) part_[node(k)] = parts_;
    cut(first, middle, left, ends);
    cut(middle, last, count - left, ends);
  }

 private:
  std::size_t node(int k) const { return static_cast<std::size_t>(order_.node[static_cast<std::size_t>(k)]); }

  /// Sorts [first, last) in breadth-first order from `root` within the current set; other connected
  /// components follow, each from its first node.
  void breadth_first(int first, int last, int root) {
    queue_.assign(1, root);
    const int part = part_[static_cast<std::size_t>(root)], seen = -1 - part;
    part_[static_cast<std::size_t>(root)] = seen;
    int next = first;
    for (std::size_t head = 0;; ++head) {
      if (head == queue_.size()) {
        while (next < last && part_[node(next)] == seen) ++next;
        if (next == last) break;
        queue_.push_back(order_.node[static_cast<std::size_t>(next)]);
        part_[static_cast<std::size_t>(queue_.back())] = seen;
      }
      const auto i = static_cast<std::size_t>(queue_[head]);
      for (int s = A_.row_start()[i]; s < A_.row_start()[i + 1]; ++s) {
        const int j = A_.columns()[static_cast<std::size_t>(s)];
        if (part_[static_cast<std::size_t>(j)] != part) continue;
        part_[static_cast<std::size_t>(j)] = seen;
        queue_.push_back(j);
      }
    }
    for (const int i : queue_) part_[static_cast<std::size_t>(i)] = part;
    std::copy(queue_.begin(), queue_.end(), order_.node.begin() + first);
  }

  const dynamics::BlockSparse& A_;
  NodeOrder& order_;
  std::vector<int> part_, queue_;
  int parts_ = 0;
};

}  // namespace

NodeOrderSizes two_level_sizes(int nodes) {
  const int clusters = std::min((nodes + kNodesOfCluster - 1) / kNodesOfCluster, kMostClusters);
  int parts = std::min(parts_of(nodes), clusters);
  // else parts would have one or two clusters each, and differ in size by a factor of two
  if (clusters == kMostClusters && parts < clusters && 2 * parts > clusters) parts = clusters / 2;
  return {clusters, parts, nodes / kNodesOfPiece};
}

NodeOrderSizes one_level_sizes(int nodes) {
  const NodeOrderSizes sizes = two_level_sizes(nodes);
  return sizes.parts == parts_of(nodes) ? sizes : NodeOrderSizes{parts_of(nodes), parts_of(nodes), 0};
}

NodeOrder cluster_nodes(const dynamics::BlockSparse& A, int clusters, int parts, int pieces) {
  const int n = A.block_rows();
  NodeOrder order;
  order.node.resize(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) order.node[static_cast<std::size_t>(i)] = i;
  order.start = order.part = order.piece_start = order.piece = {0};
  if (n == 0) return order;
  clusters = std::clamp(clusters, 1, n);
  parts = std::clamp(parts, 1, clusters);
  pieces = std::clamp(pieces, clusters, n);
  Bisection bisection(A, order);
  std::vector<int> part_start(1, 0);
  bisection.cut(0, n, parts, part_start);
  const auto cut_each = [&](const std::vector<int>& of, int count, std::vector<int>& start,
                            std::vector<int>& first) {
    const auto share = [&](std::size_t k) {
      return static_cast<int>(static_cast<std::size_t>(count) * k / (of.size() - 1));
    };
    for (std::size_t p = 0; p + 1 < of.size(); ++p) {
      bisection.cut(of[p], of[p + 1], std::min(share(p + 1) - share(p), of[p + 1] - of[p]), start);
      first.push_back(static_cast<int>(start.size()) - 1);
    }
  };
  cut_each(part_start, clusters, order.start, order.part);
  cut_each(order.start, pieces, order.piece_start, order.piece);
  return order;
}

}  // namespace palpate::linear
