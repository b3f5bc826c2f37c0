#pragma once
#include <vector>

#include "chunk_memory.h"
#include "deferred_scatter.h"
#include "element_chunks.h"
#include "law.h"
#include "matrix_scatter.h"
#include "nodal_reduction.h"

namespace palpate::fem {

/// One model per material of the body; flags and scales are equal in all.
using ElementModels = std::vector<ElementModel>;

/// Sums over the elements of one body: the law's kernels run over the chunks (element_chunks.h) on all worker
/// threads of core; nodal sums are reduced (nodal_reduction.h) and blocks scattered (matrix_scatter.h,
/// deferred_scatter.h). Contributions to shared nodes and edges are summed in the order of the chunks:
/// results do not depend on the number of threads. Memory is allocated at the first use of each function, and
/// when workers or pattern change.
class ElementEvaluation {
 public:
  /// @param rest, elements  Mesh and rest shapes of the body.
  /// @param material_of_element  Index in the ElementModels per element; empty: all 0.
  /// @param kernels  Instruction set.
  /// @param law  Index in law_registry().
  /// @param with_lower  Whether to allocate memory for unsymmetric tangents.
  ElementEvaluation(const TetMesh& rest, const RestElements& elements,
                    const std::vector<int>& material_of_element, const LaneKernels& kernels, std::size_t law,
                    bool with_lower);

  const ElementChunks& chunks() const { return chunks_; }
  const LaneKernels& kernels() const { return *kernels_; }

  /// f += nodal forces.
  LaneCounts add_force(const ElementModels& models, const BodyFields& at, double* f);
  /// f += nodal forces - stiffness times w. Without a velocity v, damping is at d_scale w.
  LaneCounts add_step_force(const ElementModels& models, const BodyFields& at, double* f);
  /// Returns the von Mises norm of the Cauchy stress of each element, averaged to the nodes by volume [Pa].
  /// Where materials meet, the average is over both: a stress that jumps there is smeared over one element.
  VecX von_mises(const ElementModels& models, const BodyFields& at);
  /// y += tangent times w.
  LaneCounts apply_tangent(const ElementModels& models, const BodyFields& at, double* y);
  /// A += tangent, in the rows of the body's nodes.
  LaneCounts add_tangent(const ElementModels& models, const BodyFields& at, int first_node,
                         dynamics::BlockSparse& A) {
    return tangent(models, at, first_node, A, false);
  }
  /// Overwrites all blocks in the rows of the body's nodes: blocks that no element contributes to become
  /// zero.
  LaneCounts store_tangent(const ElementModels& models, const BodyFields& at, int first_node,
                           dynamics::BlockSparse& A);
  /// Fused assembly: f += nodal forces - stiffness times w, and the off-diagonal blocks of
  /// k_scale K + d_scale D, times A.scale, are stored in A.
  LaneCounts add_step(const ElementModels& models, const BodyFields& at, int first_node, double* f,
                      dynamics::ZeroRowSumMatrix& A);
  /// Returns the elastic energy [J].
  double energy(const ElementModels& models, const BodyFields& at);
  /// Returns the power dissipated by damping [W].
  double dissipated_power(const ElementModels& models, const BodyFields& at);

  /// Returns the slot of the diagonal block of a node of the body. Call after add_tangent() or prepare().
  int diagonal(int node) const { return matrix_.diagonal(node); }
  /// Computes the maps into A's pattern, unless they are up to date.
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
  std::vector<ChunkMemory> memory_;  ///< one per thread
  NodalReduction nodal_;
  MatrixScatter matrix_;
  DeferredScatter deferred_;
  std::vector<double> chunk_sums_;
};

}  // namespace palpate::fem
