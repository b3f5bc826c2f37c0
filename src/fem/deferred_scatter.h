#pragma once
#include <cstdint>
#include <vector>

#include "chunk_memory.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::fem {

/// Scatters the blocks of chunks into a matrix in single precision that holds each edge once, and each
/// chunk's blocks while the elements of the next one are computed: the matrix lies far away in memory, and
/// stores are then on their way while there is arithmetic to do.
class DeferredScatter {
 public:
  /// Takes the map into A's slots: one of the last two, or a new one.  Two matrices of different orders that
  /// take turns (a step's, and one that a tool's touch is reduced with) so have one each.
  void prepare(const ElementChunks& chunks, int first_node, const dynamics::ZeroRowSumMatrix& A);
  void fit(const ElementChunks& chunks, int threads);
  /// Where a thread sums the blocks of its next chunk, and those of its last one, of which the kernel
  /// scatters a batch with each of `groups` groups of elements.
  struct Work {
    ChunkBlocks upper;
    DeferredBlocks* before;
  };
  Work begin(int thread, int groups);
  /// Defers the blocks of chunk c, the thread's current one; `last` where none is likely to follow.
  void end(const ElementChunks& chunks, int c, int thread, bool last, const SharedKernels& kernels,
           dynamics::ZeroRowSumMatrix& A);
  /// Scatters what is still deferred and adds what was put aside; after all chunks.
  void finish(const ElementChunks& chunks, const SharedKernels& kernels, dynamics::ZeroRowSumMatrix& A);
  std::size_t map_bytes() const;
  std::size_t scratch_bytes() const;

 private:
  /// What one thread has: blocks of two chunks alternately, or of one where there are few; zero between
  /// steps.
  struct Buffers {
    BlockMemory blocks[2];
    int current = 0;
    DeferredBlocks before;
  };
  /// Slot of an edge of ElementChunks::shared_edges.
  struct SharedSlot {
    std::int32_t slot;
    int edge;
  };
  static int buffers(const ElementChunks& chunks);

  std::vector<Buffers> buffers_;  ///< one a thread
  std::vector<float> shared_;     ///< nine a contribution; the matrix is no finer itself
  struct Map {
    /// of each chunk's owned edges, ascending, then of its shared ones
    std::vector<std::int32_t> slots;
    std::vector<std::uint16_t> edges;      ///< the edge of each of slots
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
