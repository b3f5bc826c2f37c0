#pragma once
#include <cstdint>

namespace palpate::integrate {

/// A symmetric matrix of 3x3 blocks in single precision, nodes in an order of its own.  Blocks are column-major, nine floats each and nothing between
/// them (the product runs at the speed of memory); kBlockTail more floats, finite, are readable behind the last.
struct SingleBlocks {
  const int* row_start;   ///< n + 1
  const int* column;      ///< ascending in a row
  const float* values;
};
constexpr int kBlockTail = 16, kVectorTail = 16;
/// Vectors over the nodes hold four numbers a node, the last of them zero, and kVectorTail readable ones behind the last node.
/// A node's inverse diagonal block is column-major with the columns' fourth entry zero.
constexpr int kInverseStride = 12;

/// At most so many vectors go through one reading of the matrix in double precision.
constexpr int kMostColumns = 3;

/// The original matrix and the way to it from the order of SingleBlocks.
struct DoubleBlocks {
  const int* row_start;
  const int* column;
  const int* source;      ///< slot of each block in `values`
  const double* values;   ///< row-major, nine a block
  int last_slot;          ///< nothing is read behind it
};

/// The inner loops over nodes [first, last), one set of them for each instruction set: one source (node_kernels.inl), compiled for each and chosen when
/// the program runs.  Sums go over a chunk in a fixed order.  The sets differ in their order of summation and in contraction, that is, in rounding.
struct NodeKernels {
  const char* name;
  /// q = A p; returns p . q
  double (*product)(const SingleBlocks& A, const float* p, float* q, int first, int last);
  /// d += a p, r -= a q, z = J r; returns r . z
  double (*update)(float a, const float* p, const float* q, const float* inverse, float* d, float* r, float* z, int first, int last);
  /// z = J r; returns r . z
  double (*jacobi)(const float* inverse, const float* r, float* z, int first, int last);
  /// y[0..5] = sum of (r, arm x r): force and moment of a cluster.  The fourth entry of an arm is 1, or 0 with a zero arm: a node that does not take part
  void (*gather_rigid)(const float* r, const float* arm, float* y, int first, int last);
  /// p = z + (w + turn x arm) + b p with w = motion[0..2], turn = motion[3..5]; motion null: p = z + b p
  void (*direction)(float b, const float* z, const float* arm, const float* motion, float* p, int first, int last);
  /// Rows [first, last) of w = E y; rows and y padded by zeros to `stride`, a multiple of 16
  void (*dense)(const float* E, int stride, const float* y, float* w, int first, int last);
  /// E = E^-1 in place, symmetric, rows of `stride`; false at a pivot that is not positive
  bool (*invert)(float* E, int size, int stride);
  /// The blocks of rows [first, last), times `scale`, into `out` (null: not); and, for `count` columns, AV = A V in double; false where a
  /// value of the copy is not finite
  bool (*convert)(const DoubleBlocks& A, double scale, float* out, int count, const double* const* V, double* const* AV, int first, int last);
  /// Inverses of the diagonal blocks times 1/scale; false where one is not positive definite
  bool (*invert_diagonal)(const double* values, const int* slot, double scale, float* inverse, int first, int last);
};

/// The widest set that this machine has.  @param limit  for tests: 0 baseline, 1 at most AVX2, 2 at most AVX-512
const NodeKernels& node_kernels(int limit = 2);

}  // namespace palpate::integrate
