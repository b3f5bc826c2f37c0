#include "scatter_map.h"

#include "palpate/core/error.h"

namespace palpate::fem {

void ScatterMap::prepare(const RestElements& elements, int first_node, const dynamics::BlockSparse& A) {
  if (A.pattern_version() == pattern_version_ && first_node == first_node_) return;
  const auto count = static_cast<std::size_t>(elements.count());
  slots_.resize(16 * count);
  for (std::size_t e = 0; e < count; ++e)
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b) {
        const int i = first_node + elements.node[a][e], j = first_node + elements.node[b][e];
        const int slot = A.slot(i, j);
        PALPATE_CHECK(slot >= 0, "nodes {} and {} of element {} are not in the pattern", i, j, e);
        slots_[16 * e + 4 * a + b] = slot;
      }
  diagonal_.resize(static_cast<std::size_t>(elements.node_count()));
  for (std::size_t i = 0; i < diagonal_.size(); ++i) diagonal_[i] = A.slot(first_node + static_cast<int>(i), first_node + static_cast<int>(i));
  pattern_version_ = A.pattern_version();
  first_node_ = first_node;
}

void ScatterMap::add(std::size_t e, const ElementBlocks& K, dynamics::BlockSparse& A) const {
  const int* slots = slots_.data() + 16 * e;
  Mat3 corner = Mat3::Zero();
  for (std::size_t a = 0; a < 3; ++a) {
    const Mat3 row = K[3 * a] + K[3 * a + 1] + K[3 * a + 2];   // K_a0 = -sum over b
    const Mat3 column = K[a] + K[3 + a] + K[6 + a];            // K_0a likewise
    corner += row;
    A.add(slots[4 * (a + 1)], -row);
    A.add(slots[a + 1], -column);
    for (std::size_t b = 0; b < 3; ++b) A.add(slots[4 * (a + 1) + b + 1], K[3 * a + b]);
  }
  A.add(slots[0], corner);
}

void add_element_pattern(const RestElements& elements, int first_node, dynamics::PatternBuilder& pattern) {
  for (std::size_t e = 0; e < static_cast<std::size_t>(elements.count()); ++e) {
    int nodes[4];
    for (std::size_t a = 0; a < 4; ++a) nodes[a] = first_node + elements.node[a][e];
    pattern.add_clique(nodes, 4);
  }
}

}  // namespace palpate::fem
