#pragma once
#include <vector>

#include "core/huge_pages.h"
#include "element_chunks.h"

// Contributions of chunks to the blocks of shared nodes and edges, nine numbers each, which are stored and
// summed afterwards.

namespace palpate::fem {

/// Adds the contributions to shared node or edge k to `to`, in order; transposed blocks if `transposed`.
template <class Real>
void add_contributions(const SharedSums& sums, int k, const std::vector<Real>& contributions, Real* to,
                       bool transposed = false) {
  for (int p = sums.start[static_cast<std::size_t>(k)]; p < sums.start[static_cast<std::size_t>(k) + 1];
       ++p) {
    const Real* block =
        contributions.data() + 9 * static_cast<std::size_t>(sums.entries[static_cast<std::size_t>(p)]);
    for (int c = 0; c < 9; ++c) to[c] += block[transposed ? c % 3 * 3 + c / 3 : c];
  }
}

/// Prefetch distance in shared edges: a sum reads and writes scattered memory.
inline constexpr int kSumsAhead = 6;
template <class Real>
void prefetch_block(const Real* block) {
  __builtin_prefetch(block);
  __builtin_prefetch(block + 8);
}
template <class Real>
void prefetch_contributions(const SharedSums& sums, int k, const Real* contributions) {
  for (int p = sums.start[static_cast<std::size_t>(k)]; p < sums.start[static_cast<std::size_t>(k) + 1]; ++p)
    prefetch_block(contributions + 9 * static_cast<std::size_t>(sums.entries[static_cast<std::size_t>(p)]));
}

/// Resizes to `count` contributions.
template <class Real>
void fit_contributions(std::vector<Real>& blocks, std::size_t count) {
  if (blocks.size() == 9 * count) return;
  blocks.resize(9 * count);
  prefer_huge_pages(blocks);
}

/// Fills `sides` with at(i, j) and at(j, i) of each edge that chunks share.
template <class At>
void find_both_sides(const SharedSums& edges, At&& at, std::vector<std::int32_t>& sides) {
  sides.resize(2 * edges.first.size());
  for (std::size_t k = 0; k < edges.first.size(); ++k) {
    sides[2 * k] = at(edges.first[k], edges.second[k]);
    sides[2 * k + 1] = at(edges.second[k], edges.first[k]);
  }
}

}  // namespace palpate::fem
