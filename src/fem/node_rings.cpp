#include "node_rings.h"

#include <algorithm>

#include "palpate/core/error.h"

namespace palpate::fem {

NodeRings::NodeRings(const RestElements& elements, const std::array<std::vector<int>, 4>& sites,
                     int site_count)
    : nodes_(elements.node_count()) {
  const auto count = static_cast<std::size_t>(elements.count());
  std::vector<std::vector<int>> rings(static_cast<std::size_t>(site_count));
  for (std::size_t e = 0; e < count; ++e)
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b)
        rings[static_cast<std::size_t>(sites[a][e])].push_back(elements.node[b][e]);
  start_.push_back(0);
  first_slot_.push_back(0);
  for (auto& ring : rings) {
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    node_.insert(node_.end(), ring.begin(), ring.end());
    start_.push_back(static_cast<int>(node_.size()));
    first_slot_.push_back(first_slot_.back() + ring.size() * ring.size());
  }
  entry_.resize(16 * count);
  for (std::size_t e = 0; e < count; ++e)
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b) {
        const int n = sites[a][e];
        entry_[16 * e + 4 * a + b] = static_cast<int>(
            std::lower_bound(node_.begin() + begin(n), node_.begin() + begin(n + 1), elements.node[b][e]) -
            node_.begin());
      }
}

void NodeRings::add_pattern(int first_node, dynamics::PatternBuilder& pattern) const {
  std::vector<int> later;  // per node n: later nodes that share a ring with it
  std::vector<std::vector<int>> rings_of(static_cast<std::size_t>(nodes_));
  for (int n = 0; n < site_count(); ++n)
    for (int k = begin(n); k < begin(n + 1); ++k) rings_of[static_cast<std::size_t>(node(k))].push_back(n);
  for (int i = 0; i < nodes_; ++i) {
    later.clear();
    for (int n : rings_of[static_cast<std::size_t>(i)])
      for (int k = begin(n); k < begin(n + 1); ++k)
        if (node(k) > i) later.push_back(node(k));
    std::sort(later.begin(), later.end());
    later.erase(std::unique(later.begin(), later.end()), later.end());
    for (int j : later) pattern.add_pair(first_node + i, first_node + j);
  }
}

void NodeRings::prepare(int first_node, const dynamics::BlockSparse& A) {
  if (A.pattern_version() == pattern_version_ && first_node == first_node_) return;
  slot_.resize(first_slot_.back());
  for (int n = 0; n < site_count(); ++n)
    for (int i = 0; i < size(n); ++i)
      for (int j = 0; j < size(n); ++j) {
        const int row = first_node + node(begin(n) + i), column = first_node + node(begin(n) + j),
                  slot = A.slot(row, column);
        PALPATE_CHECK(slot >= 0, "nodes {} and {} around site {} are not in the pattern", row, column, n);
        slot_[first_slot_[static_cast<std::size_t>(n)] + static_cast<std::size_t>(i * size(n) + j)] = slot;
      }
  pattern_version_ = A.pattern_version();
  first_node_ = first_node;
}

}  // namespace palpate::fem
