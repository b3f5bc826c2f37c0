#pragma once
#include <cstdint>

namespace palpate::integrate {

/// A symmetric matrix of 3x3 blocks in single precision, nodes in an order of its own.  Blocks are column-major, nine floats each and nothing between
/// them (the product runs at the speed of memory); kBlockTail more floats, finite, are readable behind the last.
struct SingleBlocks {
  const int* row_start;   ///< n + 1
  const int* column;      ///< the row's own first, the others ascending
  const float* values;
};
constexpr int kBlockTail = 16, kVectorTail = 16;
/// Vectors over the nodes hold four numbers a node, the last of them zero, and kVectorTail readable ones behind the last node.
/// A node's inverse diagonal block is column-major with the columns' fourth entry zero.
constexpr int kInverseStride = 12;

/// At most so many vectors go through one reading of the matrix in double precision.
constexpr int kMostColumns = 5;
/// Numbers that `gram` gives.
constexpr int kMostSums = kMostColumns * (kMostColumns + 1) / 2 + kMostColumns;

/// The original matrix and the way to it from the order of SingleBlocks.
struct DoubleBlocks {
  const int* row_start;
  const int* column;
  const int* source;      ///< slot of each block in `values`
  const double* values;   ///< row-major, nine a block
  int last_slot;          ///< nothing is read behind it
};

/// A BalancedMatrix in the order of SingleBlocks; everything times its scale.
struct BalancedBlocks {
  const int* row_start;
  const int* column;
  float* values;
  const double* mass;    ///< m, four numbers a node
  double* own;           ///< the diagonal blocks in double, column-major, nine a node; three more numbers, finite, are readable behind the last
  double unit;           ///< 1 / scale
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
  /// Rows [first, last): own = m - sum of the others, and symmetric in `values`; and, for `count` columns, AV = A V in double.  False where a number is not finite
  bool (*balance)(const BalancedBlocks& A, int count, const double* const* V, double* const* AV, int first, int last);
  /// AV = A V of a matrix that is balanced
  void (*multiply_balanced)(const BalancedBlocks& A, int count, const double* const* V, double* const* AV, int first, int last);
  /// Sums over nodes [first, last): V_j . AV_i for j = 0, 1, ... and i = 0 ... j, then V_j . b, one after the other into `out`
  void (*gram)(int count, const double* const* V, const double* const* AV, const double* b, int first, int last, double* out);
  /// x = sum of y_k V_k, Ax likewise; returns |b - Ax|^2
  double (*combine)(int count, const double* y, const double* const* V, const double* const* AV, const double* b, double* x, double* Ax, int first, int last);
  /// r = by (b - Ax)
  void (*residual)(double by, const double* b, const double* Ax, float* r, int first, int last);
  /// x += by d
  void (*correct)(double by, const float* d, double* x, int first, int last);
  /// Inverses of the diagonal blocks (of nodes at slot[node], or at [node] where it is null) times 1/scale; false where one is not positive definite
  bool (*invert_diagonal)(const double* values, const int* slot, double scale, float* inverse, int first, int last);
};

/// The widest set that this machine has.  @param limit  for tests: 0 baseline, 1 at most AVX2, 2 at most AVX-512
const NodeKernels& node_kernels(int limit = 2);

}  // namespace palpate::integrate
