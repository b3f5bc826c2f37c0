#pragma once
// Scatter of a chunk's blocks to the matrix.

// A block is a row of eight doubles and one more. For vector widths below eight it is processed entry by
// entry, as the time is dominated by memory access there too.

#if PALPATE_WIDTH == 8
struct BlockSum {
  typedef double Row __attribute__((vector_size(64)));
  typedef double RowInMemory __attribute__((vector_size(64), may_alias, aligned(8)));
  typedef long long Places __attribute__((vector_size(64)));
  Row first{};
  double last = 0.0;
  PALPATE_INLINE_MEMBER static BlockSum of(const double* block_first, double block_last, bool transposed) {
    constexpr Places kPlaces[2] = {{0, 1, 2, 3, 4, 5, 6, 7}, {0, 3, 6, 1, 4, 7, 2, 5}};
    return {__builtin_shuffle(Row(*reinterpret_cast<const RowInMemory*>(block_first)), kPlaces[transposed]),
            block_last};
  }
  PALPATE_INLINE_MEMBER void subtract(const BlockSum& block) {
    first -= block.first;
    last -= block.last;
  }
  PALPATE_INLINE_MEMBER void symmetrise() {
    const Row mirrored = __builtin_shuffle(first, Places{0, 3, 6, 1, 4, 7, 2, 5});
    first = 0.5 * (first + mirrored);
  }
  PALPATE_INLINE_MEMBER void store(double* to_first, double* to_last) const {
    *reinterpret_cast<RowInMemory*>(to_first) = first;
    *to_last = last;
  }
  PALPATE_INLINE_MEMBER void add_to(double* to) const {
    *reinterpret_cast<RowInMemory*>(to) += first;
    to[8] += last;
  }
};
#else
struct BlockSum {
  double first[8] = {};
  double last = 0.0;
  PALPATE_INLINE_MEMBER static BlockSum of(const double* block_first, double block_last, bool transposed) {
    constexpr int kPlaces[2][8] = {{0, 1, 2, 3, 4, 5, 6, 7}, {0, 3, 6, 1, 4, 7, 2, 5}};
    BlockSum block;
    for (int c = 0; c < 8; ++c) block.first[c] = block_first[kPlaces[transposed][c]];
    block.last = block_last;
    return block;
  }
  PALPATE_INLINE_MEMBER void subtract(const BlockSum& block) {
    for (int c = 0; c < 8; ++c) first[c] -= block.first[c];
    last -= block.last;
  }
  PALPATE_INLINE_MEMBER void symmetrise() {
    first[1] = first[3] = 0.5 * (first[1] + first[3]);
    first[2] = first[6] = 0.5 * (first[2] + first[6]);
    first[5] = first[7] = 0.5 * (first[5] + first[7]);
  }
  PALPATE_INLINE_MEMBER void store(double* to_first, double* to_last) const {
    for (int c = 0; c < 8; ++c) to_first[c] = first[c];
    *to_last = last;
  }
  PALPATE_INLINE_MEMBER void add_to(double* to) const {
    for (int c = 0; c < 8; ++c) to[c] += first[c];
    to[8] += last;
  }
};
#endif

/// Prefetch distance in rows of the matrix: six rows, about eighty blocks, take longer to add up than a cache
/// line takes to arrive from memory.
constexpr int kRowsAhead = 6;
PALPATE_INLINE void fetch_row(const BlockTargets& targets, int n, const double* values) {
  if (n >= targets.nodes) return;
  const int begin = targets.row_start[n],
            end = targets.in_order ? targets.row_start[n + 1] : begin + targets.row_owned[n];
  // the row's blocks are mostly contiguous
  if (begin < end) fetch<3>(values + 9 * static_cast<std::int64_t>(targets.slots[begin]), 72 * (end - begin));
}

template <bool kSymmetric, bool kStored>
static void flush_rows(const BlockTargets& targets, const ChunkBlocks& upper, const ChunkBlocks& lower,
                       const ChunkBlocks& diagonal, double* values) {
  const auto at = [&](std::int32_t slot) { return values + 9 * static_cast<std::int64_t>(slot); };
  const auto put = [](const BlockSum& block, double* to) __attribute__((always_inline)) {
    if constexpr (kStored)
      block.store(to, to + 8);
    else
      block.add_to(to);
  };
  for (int n = 0; n < targets.nodes; ++n) {
    fetch_row(targets, n + kRowsAhead, values);
    BlockSum sum;
    const auto take = [&](int p) __attribute__((always_inline)) {
      const std::uint32_t edge = targets.entries[p] / 2;
      const bool second = targets.entries[p] % 2 != 0;
      const ChunkBlocks& blocks = !kSymmetric && second ? lower : upper;
      const BlockSum block = BlockSum::of(blocks.first + 8 * edge, blocks.last[edge], kSymmetric && second);
      sum.subtract(block);
      return block;
    };
    const int begin = targets.row_start[n], end = targets.row_start[n + 1],
              owned = begin + targets.row_owned[n];
    for (int p = begin; p < owned; ++p) put(take(p), at(targets.slots[p]));
    for (int p = owned; p < end; ++p) {
      const BlockSum block = take(p);
      if (targets.in_order) block.add_to(at(targets.slots[p]));
    }
    // makes the diagonal block bitwise symmetric: the two sides of an edge's block were summed in different
    // orders
    if (kSymmetric) sum.symmetrise();
    if (n < targets.owned_nodes)
      put(sum, at(targets.diagonal[n]));
    else if (targets.in_order)
      sum.add_to(at(targets.diagonal[n]));
    else
      sum.store(diagonal.first + 8 * n, diagonal.last + n);
  }
}

static void flush(const BlockTargets& targets, const ChunkBlocks& upper, const ChunkBlocks& lower,
                  bool symmetric, const ChunkBlocks& diagonal, double* values) {
  const auto run = [&](auto* rows) { rows(targets, upper, lower, diagonal, values); };
  if (symmetric)
    run(targets.stored ? flush_rows<true, true> : flush_rows<true, false>);
  else
    run(targets.stored ? flush_rows<false, true> : flush_rows<false, false>);
}
