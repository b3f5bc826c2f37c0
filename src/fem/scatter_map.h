#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "palpate/dynamics/matrix.h"
#include "rest_elements.h"

namespace palpate::fem {

/// The nine 3x3 blocks of an element matrix that belong to nodes 1, 2, 3 (index 3 (a-1) + (b-1)).  Those of node 0 follow:
/// a translation of the whole element changes nothing, so that the blocks of each row and of each column sum to zero.
using ElementBlocks = std::array<Mat3, 9>;

/// Where the 16 blocks of each element matrix stand in an assembled matrix.  Made once a pattern.
class ScatterMap {
 public:
  /// Makes the map for A's pattern and the body's first node, unless it is the one at hand.
  void prepare(const RestElements& elements, int first_node, const dynamics::BlockSparse& A);
  /// A += blocks of element e, node 0 included.
  void add(std::size_t e, const ElementBlocks& blocks, dynamics::BlockSparse& A) const;
  /// Slot of the blocks of nodes (a, b) of element e, and of the diagonal block of a node of the body.
  int slot(std::size_t e, int a, int b) const { return slots_[16 * e + static_cast<std::size_t>(4 * a + b)]; }
  int diagonal(std::size_t node) const { return diagonal_[node]; }

 private:
  std::uint64_t pattern_version_ = 0;
  int first_node_ = -1;
  std::vector<int> slots_;
  std::vector<int> diagonal_;
};

/// Adds the pairs of every element to a pattern.
void add_element_pattern(const RestElements& elements, int first_node, dynamics::PatternBuilder& pattern);

}  // namespace palpate::fem
