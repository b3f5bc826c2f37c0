#pragma once
#include <cstdint>

#include "core/instructions.h"

namespace palpate::linear {

/// Packed rows of a symmetric matrix of 3x3 blocks in single precision, in SIMD layout: the rows of one
/// part of the nodes in groups of sixteen, one row per lane; each step of a group holds one block per row.
/// Within a step, entry (r, c) of all lanes is contiguous (structure of arrays), so that a product needs no
/// shuffles but those that gather the entries of vectors. First come the blocks A_ij to nodes of the same
/// part, which also represent A_ji; then, from single_start on, the blocks to other parts. Rows shorter than
/// the longest of their group are padded with zero blocks to their own node, and lanes without a row repeat
/// the group's first row. Diagonal blocks are stored separately (`own`).
constexpr int kLanesOfGroup = 16, kNumbersOfStep = 9 * kLanesOfGroup;
struct PackedRows {
  int groups;  ///< number of groups in all parts
  /// Ranges of groups and nodes in this part.
  int first_group, last_group, first_node, last_node;
  const int* step_start;    ///< first step of each group; one more entry
  const int* single_start;  ///< first step with blocks to other parts, per group
  const int* row;           ///< 4 node; kLanesOfGroup per group
  const int* column;        ///< 4 node; kLanesOfGroup per step
  float* own;               ///< diagonal blocks of group g, in the layout of a step
  /// Entry (r, c) of the blocks of step s is at [kNumbersOfStep s + kLanesOfGroup (3 c + r)]; 64-byte
  /// aligned.
  float* values;
  /// For a zero-row-sum matrix: m, four numbers per node; row i is then m_i p_i + sum_j A_ij (p_j - p_i),
  /// without the diagonal blocks. Null for a whole matrix.
  const float* mass;
};
/// Source of the blocks: nine floats, column-major, at values[offset]; kBlockTail more floats must be
/// readable after the last block.
struct BlockSource {
  const float* values;
  /// Offsets of the diagonal blocks, kLanesOfGroup per group, then of the other blocks, kLanesOfGroup per
  /// step. Lanes without a block point to a block of zeros. kStepsAhead more steps must be readable after the
  /// last.
  const int* offset;
  /// One bit per lane, for groups and then for steps: the block is to be transposed. Null: none is.
  const std::uint16_t* transposed;
};
constexpr int kBlockTail = 16, kVectorTail = 16, kStepsAhead = 4;
/// Vectors over the nodes hold four numbers per node, the fourth one zero, and kVectorTail zeros after the
/// last node. Inverses of diagonal blocks are stored for four nodes together: xx yy zz 0 of each, then yz xz
/// xy 0 of each.
constexpr int kInversesOfFour = 32, kToOffDiagonal = 16;
/// Returns the index of a node's inverse diagonal block.
constexpr std::int64_t inverse_place(int node) {
  return kInversesOfFour * static_cast<std::int64_t>(node / 4) + 4 * (node % 4);
}

/// Most vectors per pass over the matrix.
constexpr int kMostColumns = 5;
/// Most sums that `gram` computes.
constexpr int kMostSums = kMostColumns * (kMostColumns + 1) / 2 + kMostColumns + 1;

/// Rows of the original matrix in double precision, by the order of the nodes here.
struct DoubleBlocks {
  const int* row_start;
  const int* column;
  const int* source;     ///< slot of each block in `values`
  const double* values;  ///< row-major, nine per block
  int last_slot;         ///< last readable block
};

/// Outcome of completing rows: kNotFinite: a value is not finite; kNotDefinite: a diagonal block is not
/// positive definite.
enum class RowStatus { kOk, kNotFinite, kNotDefinite };

/// Inner loops over nodes [first, last), as one table of functions per instruction set: one source
/// (node_kernels.inl) is compiled for each set, and the table is selected at run time. Sums over a range of
/// nodes have a fixed order. The sets differ in order of summation and in contraction to FMA, that is, in
/// rounding.
struct NodeKernels {
  const char* name;
  /// q = A p on these rows; returns p . q.
  double (*product)(const PackedRows& A, const float* p, float* q);
  /// Copies blocks into the packed layout.
  void (*pack)(const PackedRows& A, const BlockSource& from);
  /// Packs a zero-row-sum matrix, computes its diagonal blocks m - sum_j A_ij and their inverses, and
  /// AV = A V for `count` columns. sums: work memory of eight numbers per node. trace: sum of the traces of
  /// the diagonal blocks.
  RowStatus (*complete)(const PackedRows& A, const BlockSource& from, float* sums, float* inverse,
                        double* trace, int count, const float* const* V, float* const* AV);
  /// AV = A V on these rows for `count` columns.
  void (*multiply)(const PackedRows& A, int count, const float* const* V, float* const* AV);
  /// Av = unit A v for a zero-row-sum matrix on these rows, in double; mass: m, four numbers per node.
  void (*multiply_zero_row_sum)(const PackedRows& A, const double* mass, double unit, const double* v,
                                double* Av);
  /// r -= a q, z = J r; returns r . z.
  double (*update)(float a, const float* q, const float* inverse, float* r, float* z, int first, int last);
  /// z = J r; returns r . z.
  double (*jacobi)(const float* inverse, const float* r, float* z, int first, int last);
  /// y[0..5] = sum of (r, arm x r): force and moment on a cluster. The fourth entry of an arm is 1, or 0
  /// (with a zero arm) for a node that does not take part.
  void (*gather_rigid)(const float* r, const float* arm, float* y, int first, int last);
  /// d += a p, then p = z + (w + turn x arm) + b p with w = motion[0..2], turn = motion[3..5]; without motion
  /// (null) p = z + b p.
  void (*direction)(float a, float b, const float* z, const float* arm, const float* motion, float* d,
                    float* p, int first, int last);
  /// First direction: d = 0, p = z + (w + turn x arm).
  void (*first_direction)(const float* z, const float* arm, const float* motion, float* d, float* p,
                          int first, int last);
  /// Rows [first, last) of w = E y; rows of E and y are padded with zeros to `stride`, a multiple of 16.
  void (*dense)(const float* E, int stride, const float* y, float* w, int first, int last);
  /// E = E^-1 in place, symmetric, rows of `stride`; returns false at a pivot that is not positive.
  bool (*invert)(float* E, int size, int stride);
  /// out[i + rows j] = V_i . W_j over `size` numbers, a multiple of four, and the zeros after them.
  void (*inner_products)(int rows, int columns, const float* const* V, const float* const* W,
                         std::int64_t size, double* out);
  /// W_j += sum_i V_i Y[i + from j]
  void (*add_columns)(int from, int to, const float* const* V, const float* Y, float* const* W,
                      std::int64_t size);
  /// out = scale times the blocks of rows [first, last); returns false if a value of the copy is not finite.
  bool (*convert)(const DoubleBlocks& A, double scale, float* out, int first, int last);
  /// Rows [first, last) of Av = A v in double.
  void (*multiply_double)(const DoubleBlocks& A, const double* v, double* Av, int first, int last);
  // Transfers between an iteration and its caller; x and Ax begin with the numbers of node `first`.
  /// Sums over nodes [first, last), written to `out` in this order: V_j . AV_i for j = 0, 1, ... and
  /// i = 0 ... j; V_j . b; |b - sum_k y_k AV_k|^2.
  void (*gram)(int count, const double* y, const float* const* V, const float* const* AV, const double* b,
               int first, int last, double* out);
  /// x = sum_k y_k V_k
  void (*combine)(int count, const double* y, const float* const* V, double* x, int first, int last);
  /// r = by (b - sum_k y_k AV_k)
  void (*leave)(int count, const double* y, double by, const float* const* AV, const double* b, float* r,
                int first, int last);
  /// Updates backward differences: V_0 = by x; V_n = new V_n-1 - change * old V_n-1.
  void (*difference)(int count, double by, double change, const double* x, float* const* V, int first,
                     int last);
  /// r = by (b - Ax); here Ax covers all nodes.
  void (*residual)(double by, const double* b, const double* Ax, float* r, int first, int last);
  /// Ax = b - by r
  void (*image)(double by, const double* b, const float* r, double* Ax, int first, int last);
  /// x += by (d + a p)
  void (*correct)(double by, const float* d, float a, const float* p, double* x, int first, int last);
  /// out[3 node[k] + axis] = x for nodes k in [first, last); returns the largest absolute value, ignoring
  /// NaN.
  double (*scatter_nodes)(const int* node, const double* x, double* out, int first, int last);
  /// x += in[3 node[k] + axis]
  void (*add_nodes)(const int* node, const double* in, double* x, int first, int last);
  /// Computes the inverses of the diagonal blocks at slot[node], times 1/scale; returns false if one is not
  /// positive definite.
  bool (*invert_diagonal)(const double* values, const int* slot, double scale, float* inverse, int first,
                          int last);
};

/// Returns the table for best_instructions().
/// @param limit  Highest instruction set, for tests: 0 baseline, 1 AVX2, 2 AVX-512.
const NodeKernels& node_kernels(int limit = static_cast<int>(best_instructions()));

}  // namespace palpate::linear
