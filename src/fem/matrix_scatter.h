#pragma once
#include <cstdint>
#include <vector>

#include "chunk_memory.h"
#include "palpate/dynamics/matrix.h"

namespace palpate::fem {

/// Scatters the blocks of chunks into an assembled matrix in double precision.
class MatrixScatter {
 public:
  /// Computes the maps into A's pattern, unless they are up to date.
  void prepare(const ElementChunks& chunks, int first_node, const dynamics::BlockSparse& A);
  /// Allocates memory for the contributions that several threads store.
  void fit(const ElementChunks& chunks, bool with_lower);
  /// Returns the slot of the diagonal block of a node of the body. Call after prepare().
  int diagonal(int node) const { return diagonal_[static_cast<std::size_t>(node)]; }
  /// Sets blocks in the rows of the body that no element writes to zero.
  void clear_bare_slots(dynamics::BlockSparse& A) const;
  /// Adds the blocks of a chunk to A, or stores them there; blocks of shared edges and nodes are added at
  /// once only in order, else stored for finish(). May be called by several threads.
  void add(const ElementChunks& chunks, const ElementChunks::Chunk& chunk, const SharedKernels& kernels,
           ChunkMemory& memory, bool symmetric, bool stored, dynamics::BlockSparse& A);
  /// Adds the stored contributions. Call after all chunks.
  void finish(const ElementChunks& chunks, bool symmetric, dynamics::BlockSparse& A) const;
  std::size_t map_bytes() const;
  std::size_t scratch_bytes() const;

 private:
  void find_unwritten_slots(const ElementChunks& chunks, int first_node, const dynamics::BlockSparse& A);

  std::vector<double> shared_upper_, shared_lower_, shared_diagonal_;  ///< nine numbers per contribution
  // maps
  std::uint64_t pattern_version_ = 0;
  int first_node_ = -1;
  std::vector<std::int32_t> slots_;           ///< slot of each entry in ElementChunks::row_edges
  std::vector<std::int32_t> bare_slots_;      ///< slots in the body's rows that no element adds to
  std::vector<std::int32_t> chunk_diagonal_;  ///< diagonal slot of each node of each chunk
  std::vector<std::int32_t> shared_slots_;    ///< slots of (i, j) and (j, i) for each shared edge
  std::vector<std::int32_t> diagonal_;        ///< diagonal slot of each node of the body
};

}  // namespace palpate::fem
