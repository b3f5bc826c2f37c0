#pragma once
#include <vector>

#include "chunk_memory.h"
#include "deferred_scatter.h"
#include "element_chunks.h"
#include "law.h"
#include "matrix_scatter.h"
#include "nodal_reduction.h"

namespace palpate::fem {

/// One a material of the body; their flags and scales agree.
using ElementModels = std::vector<ElementModel>;

/// Sums over the elements of one body: the law's kernels run over the chunks (the partition,
/// element_chunks.h), on as many threads as core's workers have; nodal sums are reduced (nodal_reduction.h)
/// and blocks scattered (matrix_scatter.h, deferred_scatter.h).  What chunks share is summed in their order:
/// results do not depend on the number of threads.  Memory is set aside when something is first asked for,
/// and when workers or pattern change.
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
  /// The rows of the body's nodes, whole: zeros where the pattern has more, whatever was there.
  LaneCounts store_tangent(const ElementModels& models, const BodyFields& at, int first_node,
                           dynamics::BlockSparse& A);
  /// Fused assembly: f += forces - stiffness times w, and the off-diagonal blocks of k_scale K + d_scale D,
  /// times A.scale, stored in A.
  LaneCounts add_step(const ElementModels& models, const BodyFields& at, int first_node, double* f,
                      dynamics::ZeroRowSumMatrix& A);
  double energy(const ElementModels& models, const BodyFields& at);
  double dissipated_power(const ElementModels& models, const BodyFields& at);

  /// Slot of the diagonal block of a node of the body; after add_tangent or prepare.
  int diagonal(int node) const { return matrix_.diagonal(node); }
  /// Makes the maps into A's pattern, unless they are the ones at hand.
  void prepare(int first_node, const dynamics::BlockSparse& A) { matrix_.prepare(chunks_, first_node, A); }
  std::size_t map_bytes() const { return matrix_.map_bytes() + deferred_.map_bytes(); }
  std::size_t scratch_bytes() const;

 private:
  using NodalKernel = decltype(LawKernels::force);

  void fit();
  void fit_blocks();
  LaneCounts collect_counts();
  LaneCounts add_nodal(NodalKernel kernel, const ElementModels& models, const BodyFields& at, double* out);
  LaneCounts tangent(const ElementModels& models, const BodyFields& at, int first_node,
                     dynamics::BlockSparse& A, bool stored);
  template <class Kernel>
  double sum_over_elements(const BodyFields& at, const Kernel& kernel);

  ElementChunks chunks_;
  const LaneKernels* kernels_;
  const LawKernels* law_;
  ScalarPath scalar_;
  bool with_lower_;
  std::vector<ChunkMemory> memory_;  ///< one a thread
  NodalReduction nodal_;
  MatrixScatter matrix_;
  DeferredScatter deferred_;
  std::vector<double> chunk_sums_;
};

}  // namespace palpate::fem
