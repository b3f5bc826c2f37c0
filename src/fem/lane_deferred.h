#pragma once
// Scatter of blocks into a matrix in single precision, which stores each block as it is.

#if PALPATE_WIDTH == 8
PALPATE_INLINE void store_single(const double* first, double last, float* to) {
  typedef double Row __attribute__((vector_size(64), may_alias));
  typedef float Singles __attribute__((vector_size(32)));
  typedef float SinglesInMemory __attribute__((vector_size(32), may_alias, aligned(4)));
  *reinterpret_cast<SinglesInMemory*>(to) =
      __builtin_convertvector(*reinterpret_cast<const Row*>(first), Singles);
  to[8] = static_cast<float>(last);
}
#else
PALPATE_INLINE void store_single(const double* first, double last, float* to) {
  for (int c = 0; c < 8; ++c) to[c] = static_cast<float>(first[c]);
  to[8] = static_cast<float>(last);
}
#endif

PALPATE_INLINE void add_single(const double* first, double last, float* to) {
  for (int c = 0; c < 8; ++c) to[c] += static_cast<float>(first[c]);
  to[8] += static_cast<float>(last);
}

/// Prefetches the destinations of the batch after the next, so that stores hit the cache and do not delay the
/// stores of the following elements.
PALPATE_INLINE void fetch_slots(const DeferredBlocks& blocks, int begin, int end) {
  const int last = blocks.shared ? blocks.owned : blocks.count;
  for (int k = begin; k < end && k < last; ++k)
    fetch<2>(blocks.values + 9 * static_cast<std::int64_t>(blocks.slots[k]) + 8, 64);
}

static void scatter(DeferredBlocks& blocks, int count) {
  const int end = blocks.count - blocks.done < count ? blocks.count : blocks.done + count;
  for (int k = blocks.done; k < end; ++k) {
    const std::uint16_t edge = blocks.edges[k];
    double *first = blocks.upper.first + 8 * edge, &last = blocks.upper.last[edge];
    if (k < blocks.owned)
      store_single(first, last, blocks.values + 9 * static_cast<std::int64_t>(blocks.slots[k]));
    else if (blocks.shared)
      store_single(first, last, blocks.shared + 9 * static_cast<std::int64_t>(k - blocks.owned));
    else
      add_single(first, last, blocks.values + 9 * static_cast<std::int64_t>(blocks.slots[k]));
    for (int part = 0; part < 8; part += kWidth) *reinterpret_cast<PackInMemory*>(first + part) = Pack{};
    last = 0.0;
  }
  blocks.done = end;
  fetch_slots(blocks, end + count, end + 2 * count);
}
