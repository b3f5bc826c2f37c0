#pragma once
#include <cstdint>
#include <vector>

#include "element_chunks.h"
#include "law.h"
#include "palpate/dynamics/balanced_matrix.h"

namespace palpate::fem {

/// Nodal vectors of a body, three doubles a node.
struct BodyFields {
  const double* x = nullptr;   ///< positions [m]
  const double* v = nullptr;   ///< velocities [m/s]
  const double* w = nullptr;   ///< a direction
  const double* dv = nullptr;  ///< what is added to v [m/s]
};

/// One a material of the body; their flags and scales agree.
using ElementModels = std::vector<ElementModel>;

/// Sums over the elements of one body: the kernels run over the chunks, on as many threads as core's workers
/// have, and what chunks share is summed in their order.  Results do not depend on the number of threads.
/// Memory is set aside when something is first asked for, and when workers or pattern change.
class ElementEvaluation {
 public:
  /// @param material_of_element  numbers in the ElementModels; empty: all 0
  /// @param law  place in law_registry()  @param with_lower  room for unsymmetric tangents
  ElementEvaluation(const TetMesh& rest, const RestElements& elements,
                    const std::vector<int>& material_of_element, const LaneKernels& kernels, std::size_t law,
                    bool with_lower);

  const ElementChunks& chunks() const { return chunks_; }
  const LaneKernels& kernels() const { return *kernels_; }

  LaneCounts add_force(const ElementModels& models, const BodyFields& at, double* f);
  /// f += forces - stiffness times w.
  LaneCounts add_step_force(const ElementModels& models, const BodyFields& at, double* f);
  LaneCounts apply_tangent(const ElementModels& models, const BodyFields& at, double* y);
  LaneCounts add_tangent(const ElementModels& models, const BodyFields& at, int first_node,
                         dynamics::BlockSparse& A) {
    return tangent(models, at, first_node, A, false);
  }
  /// The rows of the body's nodes, whole: zeros where the pattern has more, whatever stood there.
  LaneCounts store_tangent(const ElementModels& models, const BodyFields& at, int first_node,
                           dynamics::BlockSparse& A);
  /// f += forces - stiffness times w, and the off-diagonal blocks of k_scale K + d_scale D, times A.scale,
  /// stored in A.
  LaneCounts add_step(const ElementModels& models, const BodyFields& at, int first_node, double* f,
                      dynamics::BalancedMatrix& A);
  double energy(const ElementModels& models, const BodyFields& at);
  double dissipated_power(const ElementModels& models, const BodyFields& at);

  /// Slot of the diagonal block of a node of the body; after add_tangent or prepare.
  int diagonal(int node) const { return diagonal_[static_cast<std::size_t>(node)]; }
  /// Makes the maps into A's pattern, unless they are the ones at hand.
  void prepare(int first_node, const dynamics::BlockSparse& A);
  std::size_t map_bytes() const;
  std::size_t scratch_bytes() const;

 private:
  struct alignas(64) Line {
    double value[8];
  };

  struct BlockMemory {
    std::vector<Line> first;  ///< rows of eight
    std::vector<double> last;
    void resize(std::size_t count);
    ChunkBlocks blocks();
    std::size_t bytes() const { return first.capacity() * sizeof(Line) + last.capacity() * sizeof(double); }
  };

  /// Memory of one thread.
  struct Scratch {
    std::vector<Line> x, v, w, sum;  ///< nodal, four doubles a node
    BlockMemory upper, lower, diagonal;
    /// blocks of two chunks by turns (of few chunks, of one), zero between steps
    BlockMemory leaving[2];
    int turn = 0;
    LeavingBlocks before;  ///< of the chunk before
    ComingNodes coming;
    ComingRows rows;
    LaneCounts counts;
  };

  /// Of an edge of ElementChunks::late_edges in a BalancedMatrix.
  struct LatePlace {
    std::int32_t place;
    int edge;
  };

  template <class F>
  void for_each_run(const ElementChunks::Chunk& chunk, const ElementModels& models, F&& f) const;
  template <class F>
  void for_each_run_with_edges(const ElementChunks::Chunk& chunk, const ElementModels& models, F&& f) const;
  using NodalKernel = decltype(LawKernels::force);

  int turns() const;
  void fit_scratch();
  void fit_blocks();   ///< for matrices in double
  void fit_leaving();  ///< for balanced ones
  LaneCounts collect_counts();
  int groups_of(const ElementChunks::Chunk& chunk) const;
  ComingNodes coming_nodes(int c, const BodyFields& at, const double* out) const;
  ChunkFields load(int c, const BodyFields& at, Scratch& scratch, const double* out = nullptr) const;
  bool in_order() const;
  void flush_nodal(const ElementChunks::Chunk& chunk, const double* sum, double* out);
  void add_late_nodes(double* out) const;
  void find_bare_slots(int first_node, const dynamics::BlockSparse& A);
  void prepare_places(int first_node, const dynamics::BalancedMatrix& A);
  void add_late_blocks(dynamics::BalancedMatrix& A) const;
  LaneCounts tangent(const ElementModels& models, const BodyFields& at, int first_node,
                     dynamics::BlockSparse& A, bool stored);
  LaneCounts add_nodal(NodalKernel kernel, const ElementModels& models, const BodyFields& at, double* out);
  void add_late_blocks(bool symmetric, dynamics::BlockSparse& A) const;

  ElementChunks chunks_;
  const LaneKernels* kernels_;
  const LawKernels* law_;
  ScalarPath scalar_;
  bool with_lower_;
  std::vector<Scratch> scratch_;                 ///< one a thread
  std::vector<Line> late_nodes_;                 ///< half a line a contribution
  std::vector<double> late_upper_, late_lower_;  ///< nine doubles a contribution
  /// nine a contribution to a BalancedMatrix, which is no finer itself
  std::vector<float> late_single_;
  std::vector<double> late_diagonal_;
  std::vector<double> chunk_sums_;
  // the maps
  std::uint64_t pattern_version_ = 0;
  int first_node_ = -1;
  std::vector<std::int32_t> slots_;       ///< of each entry of ElementChunks::row_edges
  std::vector<std::int32_t> bare_slots_;  ///< in the body's rows, that no element adds to
  /// in a BalancedMatrix, of each chunk's own edges, ascending, then of its late ones
  std::vector<std::int32_t> places_;
  std::vector<std::uint16_t> leaving_edges_;  ///< the edge of each of places_
  std::vector<LatePlace> late_places_;        ///< ascending
  std::uint64_t places_version_ = 0;
  int places_first_node_ = -1;
  std::vector<std::int32_t> chunk_diagonal_;  ///< of each node of each chunk
  std::vector<std::int32_t> late_slots_;      ///< (i, j) and (j, i) of each late edge
  std::vector<std::int32_t> diagonal_;        ///< of each node of the body
};

}  // namespace palpate::fem
