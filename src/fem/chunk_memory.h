#pragma once
#include <vector>

#include "element_chunks.h"

namespace palpate::fem {

/// Nodal vectors of a body, three doubles a node.
struct BodyFields {
  const double* x = nullptr;   ///< positions [m]
  const double* v = nullptr;   ///< velocities [m/s]
  const double* w = nullptr;   ///< a direction
  const double* dv = nullptr;  ///< what is added to v [m/s]
};

/// A cache line of doubles: vectors of them are aligned as the kernels ask.
struct alignas(64) Line {
  double value[8];
};
inline double* numbers(std::vector<Line>& lines) { return lines.empty() ? nullptr : lines.front().value; }

/// Blocks of one chunk, one an edge or node.
struct BlockMemory {
  std::vector<Line> first;  ///< entries 0 to 7 of a block
  std::vector<double> last;
  void resize(std::size_t count);
  ChunkBlocks blocks() { return {numbers(first), last.data()}; }
  std::size_t bytes() const { return first.capacity() * sizeof(Line) + last.capacity() * sizeof(double); }
};

/// What one thread needs to work on one chunk after the other: its nodal vectors, copied together, and the
/// sums over its elements.
class ChunkMemory {
 public:
  void fit(const ElementChunks& chunks);
  /// The nodal vectors of chunk c; behind its nodes stand the corners of the unit tetrahedron that fills up
  /// groups.  @param out  what is added to when the chunk is done
  ChunkFields load(const ElementChunks& chunks, int c, const BodyFields& at, const double* out = nullptr);
  /// Nodal sums of a chunk, four doubles a node, set to zero.
  double* zeroed_sum(const ElementChunks::Chunk& chunk);
  std::size_t bytes() const;

  BlockMemory upper, lower, diagonal;  ///< blocks of one chunk, for matrices in double precision
  RowPrefetch rows;
  LaneCounts counts;

 private:
  std::vector<Line> x_, v_, w_, sum_;  ///< nodal, four doubles a node
  NodePrefetch nodes_;
};

/// Bytes that a vector holds.
template <class T>
std::size_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

/// Groups of elements in a chunk.
int groups_of(const ElementChunks& chunks, const ElementChunks::Chunk& chunk);

}  // namespace palpate::fem
