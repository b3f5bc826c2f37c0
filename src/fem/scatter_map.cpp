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
  pattern_version_ = A.pattern_version();
  first_node_ = first_node;
}

void add_element_pattern(const RestElements& elements, int first_node, dynamics::PatternBuilder& pattern) {
  for (std::size_t e = 0; e < static_cast<std::size_t>(elements.count()); ++e) {
    int nodes[4];
    for (std::size_t a = 0; a < 4; ++a) nodes[a] = first_node + elements.node[a][e];
    pattern.add_clique(nodes, 4);
  }
}

}  // namespace palpate::fem
