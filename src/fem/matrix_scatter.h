#pragma once
#include <cstdint>
#include <vector>

#include "chunk_memory.h"
#include "palpate/dynamics/matrix.h"

namespace palpate::fem {

/// Scatters the blocks of chunks into an assembled matrix in double precision.
class MatrixScatter {
 public:
  /// Makes the maps into A's pattern, unless they are the ones at hand.
  void prepare(const ElementChunks& chunks, int first_node, const dynamics::BlockSparse& A);
  /// Room for what several threads put aside.
  void fit(const ElementChunks& chunks, bool with_lower);
  /// Slot of the diagonal block of a node of the body; after prepare.
  int diagonal(int node) const { return diagonal_[static_cast<std::size_t>(node)]; }
  /// Zeros in the rows of the body that no element writes.
  void clear_bare_slots(dynamics::BlockSparse& A) const;
  /// Adds the blocks of a chunk to A, or stores them there; those of shared edges and nodes at once only in
  /// order.  Chunks may come from several threads.
  void add(const ElementChunks& chunks, const ElementChunks::Chunk& chunk, const SharedKernels& kernels,
           ChunkMemory& memory, bool symmetric, bool stored, dynamics::BlockSparse& A);
  /// Adds what was put aside; after all chunks.
  void finish(const ElementChunks& chunks, bool symmetric, dynamics::BlockSparse& A) const;
  std::size_t map_bytes() const;
  std::size_t scratch_bytes() const;

 private:
  void find_bare_slots(const ElementChunks& chunks, int first_node, const dynamics::BlockSparse& A);

  std::vector<double> shared_upper_, shared_lower_, shared_diagonal_;  ///< nine a contribution
  // the maps
  std::uint64_t pattern_version_ = 0;
  int first_node_ = -1;
  std::vector<std::int32_t> slots_;           ///< of each entry of ElementChunks::row_edges
  std::vector<std::int32_t> bare_slots_;      ///< in the body's rows, that no element adds to
  std::vector<std::int32_t> chunk_diagonal_;  ///< of each node of each chunk
  std::vector<std::int32_t> shared_slots_;    ///< (i, j) and (j, i) of each shared edge
  std::vector<std::int32_t> diagonal_;        ///< of each node of the body
};

}  // namespace palpate::fem
