#pragma once
#include <algorithm>
#include <vector>

#include "chunk_memory.h"
#include "palpate/core/workers.h"

namespace palpate::fem {

/// Whether chunks are processed in order, so that a contribution to a shared node or edge is added at once.
/// Several threads store such contributions and add them afterwards in the order of the chunks, which yields
/// bitwise equal sums.
inline bool in_order() { return workers::count() == 1; }

/// Runs f(k) for k in [0, count) on all workers, in tasks of many k.
template <class F>
void for_each_sum(int count, F&& f) {
  constexpr int kSumsInTask = 512;
  workers::for_each((count + kSumsInTask - 1) / kSumsInTask, [&](int task, int) {
    for (int k = task * kSumsInTask; k < std::min(count, (task + 1) * kSumsInTask); ++k) f(k);
  });
}

/// Reduces the nodal sums of chunks to a nodal vector of the body.
class NodalReduction {
 public:
  /// Allocates memory for stored contributions.
  void fit(const ElementChunks& chunks);
  /// Adds the sums of a chunk's nodes, four doubles per node, to `out`; sums of shared nodes are added at
  /// once only in order, else stored for finish(). May be called by several threads.
  void add(const ElementChunks& chunks, const ElementChunks::Chunk& chunk, const double* sum, double* out);
  /// Adds the stored contributions. Call after all chunks.
  void finish(const ElementChunks& chunks, double* out) const;
  std::size_t bytes() const { return bytes_of(shared_); }

 private:
  std::vector<Line> shared_;  ///< half a line per contribution
};

}  // namespace palpate::fem
