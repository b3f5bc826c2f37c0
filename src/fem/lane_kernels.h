#pragma once
#include <cstddef>
#include <cstdint>

/// The element kernels as plain functions on plain data.  Their sources (lanes_*.cpp, one for each
/// constitutive law and one for what does not depend on it) are compiled for several instruction sets, so
/// this header may hold no inline function and no template: the linker would keep one copy of it, made for
/// whichever set it met first.
namespace palpate::fem {

/// Eight tetrahedra side by side, one lane each.  Nodes and edges are numbered within a chunk of elements
/// (element_chunks.h). The corners of an element ascend by node number, so that block K_ab, a < b, of its
/// matrix belongs above the diagonal of the whole.
///
/// The material is isotropic, so that nothing changes when an element's rest shape is rotated: with F' = F Q
/// for a rotation Q, R' = R Q, P' = P Q, and P g, F g, R g, F F^T are what they were.  Q is taken from Dm = Q
/// T, T upper triangular (corner 1 on the x axis, corner 2 in the xy plane), and T^-1 stands for Dm^-1: six
/// numbers to read from memory instead of nine, and two thirds of the products with gradients.
struct alignas(64) ElementGroup {
  static constexpr int kLanes = 8, kCorners = 4, kEdges = 6;
  /// entries xx, xy, xz, yy, yz, zz of T^-1 [1/m]; row r is the gradient of corner r + 1
  double inverse_edges[6][8];
  double volume[8];  ///< [m^3]; 0 in lanes that only fill up the group
  std::uint16_t node[4][8];
};

/// The edges of a group's elements; apart from it, as forces need none.
struct GroupEdges {
  std::uint16_t edge[6][8];  ///< corners (0,1) (0,2) (0,3) (1,2) (1,3) (2,3)
};

/// Nodes that a thread is likely to need with its next chunk, and the nodal vectors of the body that are read
/// or added to there, three doubles a node: kernels prefetch them.
struct NodePrefetch {
  static constexpr int kMostFields = 5;
  const int* nodes = nullptr;
  const double* fields[kMostFields] = {};
  int field_count = 0, count = 0;
  int done = 0;   ///< of `count`
  int batch = 0;  ///< with each group of elements
};

/// Rows of the matrix that a chunk writes when its elements are done: kernels prefetch them.
struct RowPrefetch {
  const std::int32_t* nodes = nullptr;  ///< of the body
  const int* row_start = nullptr;       ///< in the matrix, of each node of the body, in blocks
  const double* values = nullptr;
  int count = 0;
  int done = 0;                                ///< of `count`
  const char *next = nullptr, *end = nullptr;  ///< what is left of the row at hand
};

/// Nodal vectors of one chunk, four doubles a node (x, y, z, unused), 32-byte aligned.
struct ChunkFields {
  const double* x = nullptr;           ///< positions [m]
  const double* v = nullptr;           ///< velocities [m/s]
  const double* w = nullptr;           ///< a direction
  NodePrefetch* next_nodes = nullptr;  ///< may be missing
  RowPrefetch* next_rows = nullptr;    ///< may be missing
};

/// 3x3 blocks of one chunk, one an edge: entries 0 to 7, row by row, in `first`, the last one in `last`;
/// `first` is 64-byte aligned.
struct ChunkBlocks {
  double* first = nullptr;
  double* last = nullptr;
};

/// Blocks of a chunk whose scatter into a matrix in single precision is deferred, row by row, nine floats a
/// block. That of edges[k] is stored at values[9 slots[k]] where k < owned; those of shared edges, which an
/// earlier chunk owns, at shared[9 (k - owned)], or, where there is no `shared`, added to values[9 slots[k]].
/// Blocks that are done are made zero for the next chunk.
struct DeferredBlocks {
  ChunkBlocks upper;
  const std::uint16_t* edges = nullptr;
  const std::int32_t* slots = nullptr;
  float *values = nullptr, *shared = nullptr;
  int owned = 0, count = 0;
  int done = 0;   ///< of `count`
  int batch = 0;  ///< with each group of elements
};

/// What the kernels need to know beside the elements.
struct ElementModel {
  double mu = 0.0, lambda = 0.0;                  ///< elastic [Pa]
  double damping_mu = 0.0, damping_lambda = 0.0;  ///< [Pa s]; 0: none
  bool warped = false, projected = false;         ///< the tangent; neither: exact
  /// the damping's derivative by position too, which is unsymmetric
  bool by_position = false;
  double k_scale = 0.0, d_scale = 0.0;  ///< of stiffness and damping in a tangent
};

/// Counts of lanes.
struct LaneCounts {
  long inverted = 0;   ///< det F <= 0
  long clamped = 0;    ///< exact tangents that were bounded at a singularity of the law
  long by_scalar = 0;  ///< lanes finished one by one, by the functions below
};

/// What a law leaves to scalar code, one element at a time: lanes near a singularity, and lanes that need
/// eigenvalues.  Matrices row by row; the numbers that come back are those that the law's vector code asks
/// for (law.h, lanes_*.cpp).  A law that needs no such function has a null pointer.
struct ScalarPath {
  /// What of F itself the vector code could not find.
  void (*state)(const double* F, double* state);
  /// What of the tangent it could not find, per unit of k_scale and volume; an integer for the vector code.
  int (*tangent)(const ElementModel& model, const double* F, const double* state, double* tangent);
};

/// Where the blocks of one chunk go in a matrix: row by row, one row a node, since the matrix is far larger
/// than the blocks and is best met in order.
struct BlockTargets {
  int nodes = 0, owned_nodes = 0;           ///< of the chunk; the owned ones come first
  const std::int32_t* row_start = nullptr;  ///< of each node in `entries` and `slots`
  /// how many entries of a row are owned edges; they come first
  const std::int32_t* row_owned = nullptr;
  const std::uint32_t* entries = nullptr;  ///< 2 edge, plus one where the node is the edge's second
  const std::int32_t* slots = nullptr;     ///< of each entry in the matrix
  const std::int32_t* diagonal = nullptr;  ///< slot of each node's diagonal block
  /// chunks come one after the other: shared entries go to the matrix as well; else they only count for the
  /// diagonal
  bool in_order = false;
  /// owned entries, and diagonal blocks of owned nodes, replace what the matrix has; else they are added to
  /// it
  bool stored = false;
};

/// The kernels of one constitutive law.
struct LawKernels {
  /// f += nodal forces of the groups, four doubles a node.
  void (*force)(const ElementGroup* groups, int count, const ElementModel&, const ScalarPath&,
                const ChunkFields&, double* f, LaneCounts&);
  /// y += tangent times w.
  void (*apply)(const ElementGroup* groups, int count, const ElementModel&, const ScalarPath&,
                const ChunkFields&, double* y, LaneCounts&);
  /// Blocks above the diagonal into `upper`; with by_position those below it into `lower`.
  void (*tangent)(const ElementGroup* groups, const GroupEdges* edges, int count, const ElementModel&,
                  const ScalarPath&, const ChunkFields&, const ChunkBlocks& upper, const ChunkBlocks& lower,
                  LaneCounts&);
  /// f += nodal forces - stiffness times w.
  void (*step_force)(const ElementGroup* groups, int count, const ElementModel&, const ScalarPath&,
                     const ChunkFields&, double* f, LaneCounts&);
  /// Fused assembly of one linearly implicit step: f += nodal forces - stiffness times w, and the blocks of a
  /// symmetric tangent above the diagonal.  Meanwhile the deferred blocks of the chunk before are scattered.
  void (*step)(const ElementGroup* groups, const GroupEdges* edges, int count, const ElementModel&,
               const ScalarPath&, const ChunkFields&, double* f, const ChunkBlocks& upper,
               DeferredBlocks& before, LaneCounts&);
  /// Elastic energies [J], summed by lane.
  void (*energy)(const ElementGroup* groups, int count, const ElementModel&, const ScalarPath&,
                 const ChunkFields&, double sums[8], LaneCounts&);
};

/// The kernels that every law shares.
struct SharedKernels {
  /// Adds the blocks of owned edges and nodes to the matrix (nine doubles a slot), or stores them there, and
  /// leaves the diagonal blocks of shared nodes in `diagonal`; in order, adds what is shared to the matrix as
  /// well.
  void (*flush)(const BlockTargets&, const ChunkBlocks& upper, const ChunkBlocks& lower, bool symmetric,
                const ChunkBlocks& diagonal, double* values);
  /// Scatters up to `count` more.
  void (*scatter)(DeferredBlocks&, int count);
  /// Powers of the damping [W], summed by lane.
  void (*power)(const ElementGroup* groups, int count, const ElementModel&, const ChunkFields&,
                double sums[8]);
};

/// The kernels of one instruction set.
struct LaneKernels {
  const char* name;
  const SharedKernels* shared;
  const LawKernels* const* laws;  ///< in the order of law_registry()
};

/// @param name  "baseline", "avx2" or "avx512"; nullptr where the build or the processor lacks it
const LaneKernels* find_kernels(const char* name);
/// The widest that this processor has; the environment variable PALPATE_INSTRUCTIONS may name another.
/// @throws Error when that is not to be had.
const LaneKernels& best_kernels();

}  // namespace palpate::fem
