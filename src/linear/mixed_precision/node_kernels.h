#pragma once
#include <cstdint>

#include "palpate/core/instructions.h"

namespace palpate::linear {

/// The rows of a symmetric matrix of 3x3 blocks in single precision that belong to one part of the nodes,
/// sixteen rows side by side, one a lane: in each step of a group every row meets one of its blocks.  Numbers
/// of one kind (entry r, c of the block) of all lanes follow each other, so that a product multiplies without
/// a shuffle but those that bring the entries of vectors together.  First come blocks A_ij to nodes of the
/// same part, which stand for A_ji as well; then, from single_start on, those to other parts.  Rows that are
/// shorter than the longest of their group meet themselves with a zero block, and so does the group's first
/// row in lanes without a row.  The rows' own blocks stand apart.
constexpr int kLanesOfGroup = 16, kNumbersOfStep = 9 * kLanesOfGroup;
struct PackedRows {
  int groups;  ///< of all parts
  int first_group, last_group, first_node, last_node;
  const int* step_start;    ///< first step of each group; one more entry
  const int* single_start;  ///< first step of each group to other parts
  const int* row;           ///< 4 node, kLanesOfGroup a group
  const int* column;        ///< 4 node, kLanesOfGroup a step
  float* own;               ///< own blocks of group g, as those of a step
  /// entry (r, c) of the blocks of step s at [kNumbersOfStep s + kLanesOfGroup (3 c + r)], 64-byte aligned
  float* values;
  /// of a zero-row-sum matrix m, four numbers a node: row i is m_i p_i + sum_j A_ij (p_j - p_i), of which own
  /// blocks are no part; null: a whole matrix
  const float* mass;
};
/// Where the blocks are from: nine floats, column by column, at values[offset]; kBlockTail more floats are
/// readable behind the last.
struct BlockSource {
  const float* values;
  /// kLanesOfGroup a group, of own blocks, then as many a step; of lanes without a block that of zeros;
  /// kStepsAhead more steps are readable behind the last
  const int* offset;
  /// a bit for each lane, of groups and then of steps: the block is the transposed one; null: none is
  const std::uint16_t* transposed;
};
constexpr int kBlockTail = 16, kVectorTail = 16, kStepsAhead = 4;
/// Vectors over the nodes hold four numbers a node, the last of them zero, and kVectorTail zeros behind the
/// last node. Inverses of diagonal blocks, four nodes together: xx yy zz 0 of each, then yz xz xy 0 of each.
constexpr int kInversesOfFour = 32, kToOffDiagonal = 16;
constexpr std::int64_t inverse_place(int node) {
  return kInversesOfFour * static_cast<std::int64_t>(node / 4) + 4 * (node % 4);
}

/// At most so many vectors go through one reading of the matrix.
constexpr int kMostColumns = 5;
/// Numbers that `gram` gives.
constexpr int kMostSums = kMostColumns * (kMostColumns + 1) / 2 + kMostColumns + 1;

/// The original matrix and the way to it from the order of the nodes here.
struct DoubleBlocks {
  const int* row_start;
  const int* column;
  const int* source;     ///< slot of each block in `values`
  const double* values;  ///< row-major, nine a block
  int last_slot;         ///< nothing is read behind it
};

enum class RowStatus { kOk, kNotFinite, kNotDefinite };

/// The inner loops over nodes [first, last), one set of them for each instruction set: one source
/// (node_kernels.inl), compiled for each and chosen when the program runs.  Sums go over a chunk in a fixed
/// order.  The sets differ in their order of summation and in contraction, that is, in rounding.
struct NodeKernels {
  const char* name;
  /// q = A p on these rows; returns p . q
  double (*product)(const PackedRows& A, const float* p, float* q);
  /// Brings blocks into their lanes
  void (*pack)(const PackedRows& A, const BlockSource& from);
  /// Packs a zero-row-sum matrix, of which the diagonal blocks m - sum_j A_ij and their inverses are
  /// made. And AV = A V for `count` columns. sums: room for eight numbers a node.  trace: of all the diagonal
  /// blocks
  RowStatus (*complete)(const PackedRows& A, const BlockSource& from, float* sums, float* inverse,
                        double* trace, int count, const float* const* V, float* const* AV);
  /// AV = A V on these rows for `count` columns
  void (*multiply)(const PackedRows& A, int count, const float* const* V, float* const* AV);
  /// Av = A v times `unit` of a zero-row-sum matrix on these rows, in double; mass: four numbers a node
  void (*multiply_zero_row_sum)(const PackedRows& A, const double* mass, double unit, const double* v,
                                double* Av);
  /// r -= a q, z = J r; returns r . z
  double (*update)(float a, const float* q, const float* inverse, float* r, float* z, int first, int last);
  /// z = J r; returns r . z
  double (*jacobi)(const float* inverse, const float* r, float* z, int first, int last);
  /// y[0..5] = sum of (r, arm x r): force and moment of a cluster.  The fourth entry of an arm is 1, or 0
  /// with a zero arm: a node that does not take part
  void (*gather_rigid)(const float* r, const float* arm, float* y, int first, int last);
  /// d += a p, then p = z + (w + turn x arm) + b p with w = motion[0..2], turn = motion[3..5]; motion null: p
  /// = z + b p
  void (*direction)(float a, float b, const float* z, const float* arm, const float* motion, float* d,
                    float* p, int first, int last);
  /// The first direction, where there is none yet: d = 0, p = z + (w + turn x arm)
  void (*first_direction)(const float* z, const float* arm, const float* motion, float* d, float* p,
                          int first, int last);
  /// Rows [first, last) of w = E y; rows and y padded by zeros to `stride`, a multiple of 16
  void (*dense)(const float* E, int stride, const float* y, float* w, int first, int last);
  /// E = E^-1 in place, symmetric, rows of `stride`; false at a pivot that is not positive
  bool (*invert)(float* E, int size, int stride);
  /// out[i + rows j] = V_i . W_j of all `size` numbers, a multiple of four, and of the zeros behind them
  void (*inner_products)(int rows, int columns, const float* const* V, const float* const* W,
                         std::int64_t size, double* out);
  /// W_j += the sum of V_i Y[i + from j]
  void (*add_columns)(int from, int to, const float* const* V, const float* Y, float* const* W,
                      std::int64_t size);
  /// The blocks of rows [first, last), times `scale`, into `out`; false where a value of the copy is not
  /// finite
  bool (*convert)(const DoubleBlocks& A, double scale, float* out, int first, int last);
  /// Rows [first, last) of Av = A v in double
  void (*multiply_double)(const DoubleBlocks& A, const double* v, double* Av, int first, int last);
  // Between an iteration and what it serves; x and Ax begin with the numbers of node `first`.
  /// Sums over nodes [first, last): V_j . AV_i for j = 0, 1, ... and i = 0 ... j, then V_j . b, one after the
  /// other into `out`, and |b - sum of y_k AV_k|^2
  void (*gram)(int count, const double* y, const float* const* V, const float* const* AV, const double* b,
               int first, int last, double* out);
  /// x = the sum of y_k V_k
  void (*combine)(int count, const double* y, const float* const* V, double* x, int first, int last);
  /// r = by (b - the sum of y_k AV_k)
  void (*leave)(int count, const double* y, double by, const float* const* AV, const double* b, float* r,
                int first, int last);
  /// Backward differences: V_0 becomes by x, V_n the new V_n-1 less `change` times the old one
  void (*difference)(int count, double by, double change, const double* x, float* const* V, int first,
                     int last);
  /// r = by (b - Ax), of which Ax has all nodes
  void (*residual)(double by, const double* b, const double* Ax, float* r, int first, int last);
  /// Ax = b - by r
  void (*image)(double by, const double* b, const float* r, double* Ax, int first, int last);
  /// x += by (d + a p)
  void (*correct)(double by, const float* d, float a, const float* p, double* x, int first, int last);
  /// out[3 node[k] + axis] = x of nodes k in [first, last); returns the largest of these numbers, of which
  /// those that are none do not count
  double (*put_nodes)(const int* node, const double* x, double* out, int first, int last);
  /// x += in[3 node[k] + axis]
  void (*add_nodes)(const int* node, const double* in, double* x, int first, int last);
  /// Inverses of the diagonal blocks at slot[node] times 1/scale; false where one is not positive definite
  bool (*invert_diagonal)(const double* values, const int* slot, double scale, float* inverse, int first,
                          int last);
};

/// The set that best_instructions() names.  @param limit  for tests: 0 baseline, 1 at most AVX2, 2 at most
/// AVX-512
const NodeKernels& node_kernels(int limit = static_cast<int>(best_instructions()));

}  // namespace palpate::linear
