#pragma once
#include <cstdint>
#include <vector>

#include "palpate/dynamics/matrix.h"
#include "rest_elements.h"

namespace palpate::fem {

/// Slot map of the 16 blocks of each element matrix in an assembled matrix. Computed once per pattern.
class ScatterMap {
 public:
  /// Computes the map for A's pattern and the body's first node, unless it is up to date.
  void prepare(const RestElements& elements, int first_node, const dynamics::BlockSparse& A);
  /// Returns the slot of the block of nodes (a, b) of element e.
  int slot(std::size_t e, int a, int b) const { return slots_[16 * e + static_cast<std::size_t>(4 * a + b)]; }

 private:
  std::uint64_t pattern_version_ = 0;
  int first_node_ = -1;
  std::vector<int> slots_;
};

/// Adds the node pairs of every element to a pattern.
void add_element_pattern(const RestElements& elements, int first_node, dynamics::PatternBuilder& pattern);

}  // namespace palpate::fem
