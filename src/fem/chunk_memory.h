#pragma once
#include <vector>

#include "element_chunks.h"

namespace palpate::fem {

/// Nodal vectors of a body, three doubles per node.
struct BodyFields {
  const double* x = nullptr;   ///< positions [m]
  const double* v = nullptr;   ///< velocities [m/s]
  const double* w = nullptr;   ///< a direction
  const double* dv = nullptr;  ///< increment of v [m/s]
};

/// One cache line of doubles, so that vectors of lines have the alignment that the kernels require.
struct alignas(64) Line {
  double value[8];
};
inline double* numbers(std::vector<Line>& lines) { return lines.empty() ? nullptr : lines.front().value; }

/// Blocks of one chunk, one per edge or node.
struct BlockMemory {
  std::vector<Line> first;  ///< entries 0 to 7 of a block
  std::vector<double> last;
  void resize(std::size_t count);
  ChunkBlocks blocks() { return {numbers(first), last.data()}; }
  std::size_t bytes() const { return first.capacity() * sizeof(Line) + last.capacity() * sizeof(double); }
};

/// Work memory of one thread, for one chunk after another: copies of the chunk's nodal vectors and the sums
/// over its elements.
class ChunkMemory {
 public:
  void fit(const ElementChunks& chunks);
  /// Copies the nodal vectors of chunk c. After its nodes come the corners of the unit tetrahedron that pads
  /// groups.
  /// @param chunks, c  The chunk.
  /// @param at  Nodal vectors of the body; null ones are skipped.
  /// @param out  Vector to which the chunk's result will be added, for prefetching.
  ChunkFields load(const ElementChunks& chunks, int c, const BodyFields& at, const double* out = nullptr);
  /// Returns the nodal sums of a chunk, four doubles per node, set to zero.
  double* zeroed_sum(const ElementChunks::Chunk& chunk);
  std::size_t bytes() const;

  BlockMemory upper, lower, diagonal;  ///< blocks of one chunk, for matrices in double precision
  RowPrefetch rows;
  LaneCounts counts;

 private:
  std::vector<Line> x_, v_, w_, sum_;  ///< nodal vectors, four doubles per node
  NodePrefetch nodes_;
};

/// Returns the bytes of a vector's memory.
template <class T>
std::size_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

/// Returns the number of element groups in a chunk.
int groups_of(const ElementChunks& chunks, const ElementChunks::Chunk& chunk);

}  // namespace palpate::fem
