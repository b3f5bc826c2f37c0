#pragma once
#include <cstdint>
#include <vector>

#include "chunk_memory.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::fem {

/// Scatters the blocks of chunks into a matrix in single precision that holds each edge once. The blocks of
/// one chunk are scattered while the elements of the next are computed: the matrix is far larger than the
/// cache, and stores then overlap with arithmetic.
class DeferredScatter {
 public:
  /// Prepares the map into A's slots: one of the last two, or a new one. Two matrices of different orders
  /// used in turn (the step matrix and the matrix of a reduced contact model) thus keep one map each.
  void prepare(const ElementChunks& chunks, int first_node, const dynamics::ZeroRowSumMatrix& A);
  /// Allocates the buffers of the threads.
  void fit(const ElementChunks& chunks, int threads);
  /// Buffers of a thread: sums of its next chunk, and the blocks of its last chunk, which the kernel scatters
  /// batch by batch, one batch per group of elements.
  struct Work {
    ChunkBlocks upper;
    DeferredBlocks* before;
  };
  /// Returns the buffers for a chunk with `groups` groups of elements.
  Work begin(int thread, int groups);
  /// Defers the blocks of chunk c, the thread's current one. `last`: no further chunk is likely to follow.
  void end(const ElementChunks& chunks, int c, int thread, bool last, const SharedKernels& kernels,
           dynamics::ZeroRowSumMatrix& A);
  /// Scatters the blocks still deferred and adds the stored contributions. Call after all chunks.
  void finish(const ElementChunks& chunks, const SharedKernels& kernels, dynamics::ZeroRowSumMatrix& A);
  std::size_t map_bytes() const;
  std::size_t scratch_bytes() const;

 private:
  /// Buffers of one thread: the blocks of two chunks in turn, or of one where there are few chunks; zero
  /// between steps.
  struct Buffers {
    BlockMemory blocks[2];
    int current = 0;
    DeferredBlocks before;
  };
  /// Slot of an edge in ElementChunks::shared_edges.
  struct SharedSlot {
    std::int32_t slot;
    int edge;
  };
  static int buffers(const ElementChunks& chunks);

  std::vector<Buffers> buffers_;  ///< one per thread
  std::vector<float> shared_;     ///< contributions, nine numbers each; in single precision like the matrix
  struct Map {
    /// Slots of each chunk's owned edges, ascending, then of its shared ones.
    std::vector<std::int32_t> slots;
    std::vector<std::uint16_t> edges;      ///< edge of each slot
    std::vector<SharedSlot> shared_slots;  ///< ascending
    std::uint64_t key = 0;                 ///< ZeroRowSumMatrix::slot_map_key
    int first_node = -1;
  };
  static void make(const ElementChunks& chunks, int first_node, const dynamics::ZeroRowSumMatrix& A,
                   Map& map);
  const Map& map() const { return maps_[current_]; }
  Map maps_[2];
  int current_ = 0;
};

}  // namespace palpate::fem
