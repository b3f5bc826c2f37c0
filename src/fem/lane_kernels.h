#pragma once
#include <cstddef>
#include <cstdint>

/// Element kernels as plain functions on plain data. Their sources (lanes_*.cpp, one per constitutive law and
/// one for law-independent kernels) are compiled for several instruction sets, so this header must not
/// contain inline functions or templates: the linker would keep one copy, compiled for an arbitrary set.
namespace palpate::fem {

/// Eight tetrahedra, one per SIMD lane. Nodes and edges are numbered within a chunk of elements
/// (element_chunks.h). The corners of an element ascend by node number, so that block K_ab, a < b, of its
/// matrix is above the diagonal of the assembled matrix.
///
/// The material is isotropic, so the rest shape of an element may be rotated: with F' = F Q for a rotation Q,
/// R' = R Q, P' = P Q, and P g, F g, R g, F F^T are unchanged. Q is taken from Dm = Q T, T upper triangular
/// (corner 1 on the x axis, corner 2 in the xy plane), and T^-1 replaces Dm^-1: six numbers to read from
/// memory instead of nine, and two thirds of the products with gradients.
struct alignas(64) ElementGroup {
  static constexpr int kLanes = 8, kCorners = 4, kEdges = 6;
  /// Entries xx, xy, xz, yy, yz, zz of T^-1 [1/m]; row r is the gradient of corner r + 1.
  double inverse_edges[6][8];
  double volume[8];  ///< [m^3]; 0 in padding lanes
  std::uint16_t node[4][8];
};

/// Edges of a group's elements; stored separately, as forces need none.
struct GroupEdges {
  std::uint16_t edge[6][8];  ///< corners (0,1) (0,2) (0,3) (1,2) (1,3) (2,3)
};

/// Least det F in a Cauchy stress P F^T / det F, so that pictures of flat or inverted elements show a large
/// stress, not an infinite one.
constexpr double kSmallestStressDet = 0.1;

/// Nodes that a thread is likely to need for its next chunk, and the nodal vectors of the body that are read
/// or added to there, three doubles per node: kernels prefetch them.
struct NodePrefetch {
  static constexpr int kMostFields = 5;
  const int* nodes = nullptr;
  const double* fields[kMostFields] = {};
  int field_count = 0, count = 0;
  int done = 0;   ///< number prefetched so far
  int batch = 0;  ///< number per group of elements
};

/// Matrix rows that a chunk writes when its elements are done: kernels prefetch them.
struct RowPrefetch {
  const std::int32_t* nodes = nullptr;  ///< nodes of the body
  const int* row_start = nullptr;       ///< first block of each body node's row in the matrix
  const double* values = nullptr;
  int count = 0;
  int done = 0;                                ///< number of rows prefetched so far
  const char *next = nullptr, *end = nullptr;  ///< remainder of the current row
};

/// Nodal vectors of one chunk, four doubles per node (x, y, z, unused), 32-byte aligned.
struct ChunkFields {
  const double* x = nullptr;           ///< positions [m]
  const double* v = nullptr;           ///< velocities [m/s]
  const double* w = nullptr;           ///< a direction
  NodePrefetch* next_nodes = nullptr;  ///< may be null
  RowPrefetch* next_rows = nullptr;    ///< may be null
};

/// 3x3 blocks of one chunk, one per edge: entries 0 to 7, row-major, in `first`, the last one in `last`;
/// `first` is 64-byte aligned.
struct ChunkBlocks {
  double* first = nullptr;
  double* last = nullptr;
};

/// Blocks of a chunk whose scatter into a matrix in single precision is deferred; row-major, nine floats per
/// block. The block of edges[k] is stored at values[9 slots[k]] if k < owned. Blocks of shared edges, which
/// an earlier chunk owns, are stored at shared[9 (k - owned)] or, if `shared` is null, added to values[9
/// slots[k]]. Scattered blocks are set to zero for the next chunk.
struct DeferredBlocks {
  ChunkBlocks upper;
  const std::uint16_t* edges = nullptr;
  const std::int32_t* slots = nullptr;
  float *values = nullptr, *shared = nullptr;
  int owned = 0, count = 0;
  int done = 0;   ///< number scattered so far
  int batch = 0;  ///< number per group of elements
};

/// Parameters of the kernels, per material.
struct ElementModel {
  double mu = 0.0, lambda = 0.0;                  ///< elastic constants [Pa]
  double damping_mu = 0.0, damping_lambda = 0.0;  ///< damping constants [Pa s]; 0: none
  bool warped = false, projected = false;         ///< tangent; neither: exact
  /// Whether to include the damping's derivative by position, which is unsymmetric.
  bool by_position = false;
  double k_scale = 0.0, d_scale = 0.0;  ///< scales of stiffness and damping in a tangent
};

/// Counts of elements (lanes).
struct LaneCounts {
  long inverted = 0;   ///< det F <= 0
  long clamped = 0;    ///< exact tangents that were bounded at a singularity of the law
  long by_scalar = 0;  ///< computed one by one, by the functions below
};

/// Scalar fallback of a law, one element at a time: for elements near a singularity, and elements that need
/// eigenvalues. Matrices are row-major; the output is defined by the law's vector code (law.h, lanes_*.cpp).
/// A function that the law does not need is null.
struct ScalarPath {
  /// Computes the state of F that the vector code could not.
  void (*state)(const double* F, double* state);
  /// Computes the tangent that the vector code could not, per unit of k_scale and volume; returns an integer
  /// whose meaning the vector code defines.
  int (*tangent)(const ElementModel& model, const double* F, const double* state, double* tangent);
};

/// Destinations of a chunk's blocks in a matrix, row by row, one row per node: the matrix is far larger than
/// the blocks and is best accessed in order.
struct BlockTargets {
  int nodes = 0, owned_nodes = 0;           ///< nodes of the chunk; owned ones come first
  const std::int32_t* row_start = nullptr;  ///< first index of each node in `entries` and `slots`
  /// Number of owned edges in each row; they come first.
  const std::int32_t* row_owned = nullptr;
  const std::uint32_t* entries = nullptr;  ///< 2 edge, plus one where the node is the edge's second
  const std::int32_t* slots = nullptr;     ///< slot of each entry in the matrix
  const std::int32_t* diagonal = nullptr;  ///< slot of each node's diagonal block
  /// Whether chunks are processed in order: shared entries are then added to the matrix as well; else they
  /// contribute to the diagonal only.
  bool in_order = false;
  /// Whether owned entries, and diagonal blocks of owned nodes, replace the matrix's values; else they are
  /// added.
  bool stored = false;
};

/// Kernels of one constitutive law.
struct LawKernels {
  /// f += nodal forces of the groups, four doubles per node.
  void (*force)(const ElementGroup* groups, int count, const ElementModel&, const ScalarPath&,
                const ChunkFields&, double* f, LaneCounts&);
  /// y += tangent times w.
  void (*apply)(const ElementGroup* groups, int count, const ElementModel&, const ScalarPath&,
                const ChunkFields&, double* y, LaneCounts&);
  /// Adds the blocks above the diagonal to `upper`; with by_position those below it to `lower`.
  void (*tangent)(const ElementGroup* groups, const GroupEdges* edges, int count, const ElementModel&,
                  const ScalarPath&, const ChunkFields&, const ChunkBlocks& upper, const ChunkBlocks& lower,
                  LaneCounts&);
  /// f += nodal forces - stiffness times w. Where the model has damping, its velocity is v, or d_scale w if v
  /// is null.
  void (*step_force)(const ElementGroup* groups, int count, const ElementModel&, const ScalarPath&,
                     const ChunkFields&, double* f, LaneCounts&);
  /// Fused assembly of one linearly implicit step: f += nodal forces - stiffness times w, and the blocks of a
  /// symmetric tangent above the diagonal. The deferred blocks of the previous chunk are scattered meanwhile.
  void (*step)(const ElementGroup* groups, const GroupEdges* edges, int count, const ElementModel&,
               const ScalarPath&, const ChunkFields&, double* f, const ChunkBlocks& upper,
               DeferredBlocks& before, LaneCounts&);
  /// Adds up elastic energies [J] by lane.
  void (*energy)(const ElementGroup* groups, int count, const ElementModel&, const ScalarPath&,
                 const ChunkFields&, double sums[8], LaneCounts&);
  /// Adds a quarter of each element's volume times the von Mises norm of its Cauchy stress [Pa] to the
  /// x-coordinates of its nodes, four doubles per node. det F is taken as at least kSmallestStressDet.
  void (*von_mises)(const ElementGroup* groups, int count, const ElementModel&, const ScalarPath&,
                    const ChunkFields&, double* f, LaneCounts&);
};

/// Kernels shared by all laws.
struct SharedKernels {
  /// Adds the blocks of owned edges and nodes to the matrix (nine doubles per slot), or stores them there,
  /// and leaves the diagonal blocks of shared nodes in `diagonal`; in order, it also adds shared blocks to
  /// the matrix.
  void (*flush)(const BlockTargets&, const ChunkBlocks& upper, const ChunkBlocks& lower, bool symmetric,
                const ChunkBlocks& diagonal, double* values);
  /// Scatters up to `count` more blocks.
  void (*scatter)(DeferredBlocks&, int count);
  /// Adds up the power of damping [W] by lane.
  void (*power)(const ElementGroup* groups, int count, const ElementModel&, const ChunkFields&,
                double sums[8]);
};

/// Kernels of one instruction set.
struct LaneKernels {
  const char* name;
  const SharedKernels* shared;
  const LawKernels* const* laws;  ///< in the order of law_registry()
};

/// Returns the kernels of an instruction set; nullptr if the build or the processor lacks it.
/// @param name  "baseline", "avx2" or "avx512".
const LaneKernels* find_kernels(const char* name);
/// Returns the kernels of the widest instruction set of this processor, or those of the environment variable
/// PALPATE_INSTRUCTIONS.
/// @throws Error if that set is not available
const LaneKernels& best_kernels();

}  // namespace palpate::fem
