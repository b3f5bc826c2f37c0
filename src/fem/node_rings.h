#pragma once
#include <vector>

#include "palpate/dynamics/matrix.h"
#include "rest_elements.h"

namespace palpate::fem {

/// Rings of sites. A site is a node as seen by a subset of the elements at it; its ring consists of all
/// nodes of these elements, itself included, ascending. A quantity averaged at sites depends on their rings,
/// so its square couples every pair of nodes in a ring: each node with its neighbours' neighbours.
class NodeRings {
 public:
  /// @param elements  Rest elements of the body.
  /// @param sites  Site of each corner of each element; elements.node where each node is one site.
  /// @param count  Number of sites.
  NodeRings(const RestElements& elements, const std::array<std::vector<int>, 4>& sites, int count);

  int site_count() const { return static_cast<int>(start_.size()) - 1; }
  int entry_count() const { return static_cast<int>(node_.size()); }
  /// Returns the first entry of the ring of site n.
  int begin(int n) const { return start_[static_cast<std::size_t>(n)]; }
  int size(int n) const { return begin(n + 1) - begin(n); }
  int node(int entry) const { return node_[static_cast<std::size_t>(entry)]; }
  /// Returns the entry of node b of element e in the ring of the site at its corner a.
  int entry(std::size_t e, int a, int b) const {
    return entry_[16 * e + static_cast<std::size_t>(4 * a + b)];
  }

  /// Adds the node pairs of all rings to a pattern.
  void add_pattern(int first_node, dynamics::PatternBuilder& pattern) const;
  /// Finds the slots of A for every pair of every ring, unless they are up to date.
  void prepare(int first_node, const dynamics::BlockSparse& A);
  /// Returns the slot of the i-th and j-th node of the ring of site n.
  int slot(int n, int i, int j) const {
    return slot_[first_slot_[static_cast<std::size_t>(n)] + static_cast<std::size_t>(i * size(n) + j)];
  }

 private:
  int nodes_ = 0;
  std::vector<int> start_, node_, entry_;
  std::vector<std::size_t> first_slot_;
  std::vector<int> slot_;
  std::uint64_t pattern_version_ = 0;
  int first_node_ = -1;
};

}  // namespace palpate::fem
