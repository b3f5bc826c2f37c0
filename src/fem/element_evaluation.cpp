#include "element_evaluation.h"

#include <algorithm>
#include <numeric>

#include "palpate/core/error.h"
#include "palpate/core/workers.h"
#include "palpate/fem/laws.h"

namespace palpate::fem {
namespace {

using Chunk = ElementChunks::Chunk;

void set_zero(const ChunkBlocks& blocks, int count) {
  std::fill_n(blocks.first, 8 * count, 0.0);
  std::fill_n(blocks.last, count, 0.0);
}

/// Calls f(groups, edges, count, model) for each material of a chunk.
template <class F>
void for_each_run(const ElementChunks& chunks, const Chunk& chunk, const ElementModels& models, F&& f) {
  chunks.for_each_run(chunk, [&](const ElementChunks::Run& run) {
    f(chunks.groups.data() + run.first_group, chunks.edges.data() + run.first_group, run.groups,
      models[static_cast<std::size_t>(run.material)]);
  });
}

}  // namespace

ElementEvaluation::ElementEvaluation(const TetMesh& rest, const RestElements& elements,
                                     const std::vector<int>& material_of_element, const LaneKernels& kernels,
                                     std::size_t law, bool with_lower)
    : chunks_(rest, elements, material_of_element),
      kernels_(&kernels),
      law_(kernels.laws[law]),
      scalar_(law_registry()[law].make->scalar),
      with_lower_(with_lower) {
  chunk_sums_.resize(chunks_.chunks.size());
  fit();
}

void ElementEvaluation::fit() {
  nodal_.fit(chunks_);
  const auto threads = static_cast<std::size_t>(workers::count());
  if (memory_.size() >= threads) return;
  memory_.resize(threads);
  for (ChunkMemory& memory : memory_) memory.fit(chunks_);
}

void ElementEvaluation::fit_blocks() {
  fit();
  const auto nodes = static_cast<std::size_t>(chunks_.most_nodes) + 4,
             edges = static_cast<std::size_t>(chunks_.most_edges) + 1;
  for (ChunkMemory& memory : memory_) {
    memory.upper.resize(edges);
    if (with_lower_) memory.lower.resize(edges);
    memory.diagonal.resize(nodes);
  }
  matrix_.fit(chunks_, with_lower_);
}

LaneCounts ElementEvaluation::collect_counts() {
  LaneCounts sum;
  for (ChunkMemory& memory : memory_) {
    sum.inverted += memory.counts.inverted;
    sum.clamped += memory.counts.clamped;
    sum.by_scalar += memory.counts.by_scalar;
    memory.counts = {};
  }
  return sum;
}

LaneCounts ElementEvaluation::add_nodal(NodalKernel kernel, const ElementModels& models, const BodyFields& at,
                                        double* out) {
  fit();
  workers::for_each(static_cast<int>(chunks_.chunks.size()), [&](int c, int worker) {
    const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
    ChunkMemory& memory = memory_[static_cast<std::size_t>(worker)];
    const ChunkFields fields = memory.load(chunks_, c, at, out);
    double* sum = memory.zeroed_sum(chunk);
    for_each_run(chunks_, chunk, models,
                 [&](const ElementGroup* groups, const GroupEdges*, int count, const ElementModel& model) {
                   kernel(groups, count, model, scalar_, fields, sum, memory.counts);
                 });
    nodal_.add(chunks_, chunk, sum, out);
  });
  nodal_.finish(chunks_, out);
  return collect_counts();
}

LaneCounts ElementEvaluation::add_force(const ElementModels& models, const BodyFields& at, double* f) {
  return add_nodal(law_->force, models, at, f);
}
LaneCounts ElementEvaluation::add_step_force(const ElementModels& models, const BodyFields& at, double* f) {
  return add_nodal(law_->step_force, models, at, f);
}
VecX ElementEvaluation::von_mises(const ElementModels& models, const BodyFields& at) {
  Points sums = Points::Zero(3, chunks_.node_count());
  add_nodal(law_->von_mises, models, at, sums.data());
  VecX out = sums.row(0);
  for (Eigen::Index i = 0; i < out.size(); ++i)
    if (const double volume = chunks_.nodal_volume[static_cast<std::size_t>(i)]; volume > 0.0)
      out[i] /= volume;
  return out;
}
LaneCounts ElementEvaluation::apply_tangent(const ElementModels& models, const BodyFields& at, double* y) {
  return add_nodal(law_->apply, models, at, y);
}

LaneCounts ElementEvaluation::store_tangent(const ElementModels& models, const BodyFields& at, int first_node,
                                            dynamics::BlockSparse& A) {
  prepare(first_node, A);
  matrix_.clear_bare_slots(A);
  return tangent(models, at, first_node, A, true);
}

LaneCounts ElementEvaluation::tangent(const ElementModels& models, const BodyFields& at, int first_node,
                                      dynamics::BlockSparse& A, bool stored) {
  fit_blocks();
  prepare(first_node, A);
  const bool symmetric = !models.front().by_position;
  PALPATE_CHECK(symmetric || with_lower_,
                "an unsymmetric tangent needs full_damping_tangent, which was not set");
  workers::for_each(static_cast<int>(chunks_.chunks.size()), [&](int c, int worker) {
    const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
    ChunkMemory& memory = memory_[static_cast<std::size_t>(worker)];
    const ChunkBlocks upper = memory.upper.blocks(), lower = memory.lower.blocks();
    set_zero(upper, chunk.edges + 1);
    if (!symmetric) set_zero(lower, chunk.edges + 1);
    ChunkFields fields = memory.load(chunks_, c, at);
    memory.rows = {chunks_.nodes.data() + chunk.first_node, A.row_start().data() + first_node,
                   A.values().data(), in_order() ? chunk.nodes : chunk.owned_nodes};
    fields.next_rows = &memory.rows;
    for_each_run(
        chunks_, chunk, models,
        [&](const ElementGroup* groups, const GroupEdges* edges, int count, const ElementModel& model) {
          law_->tangent(groups, edges, count, model, scalar_, fields, upper, lower, memory.counts);
        });
    matrix_.add(chunks_, chunk, *kernels_->shared, memory, symmetric, stored, A);
  });
  matrix_.finish(chunks_, symmetric, A);
  return collect_counts();
}

LaneCounts ElementEvaluation::add_step(const ElementModels& models, const BodyFields& at, int first_node,
                                       double* f, dynamics::ZeroRowSumMatrix& A) {
  fit();
  deferred_.fit(chunks_, workers::count());
  deferred_.prepare(chunks_, first_node, A);
  PALPATE_CHECK(!models.front().by_position,
                "an unsymmetric tangent cannot be added to a zero-row-sum matrix");
  const int chunks = static_cast<int>(chunks_.chunks.size());
  workers::for_each(chunks, [&](int c, int worker) {
    const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
    ChunkMemory& memory = memory_[static_cast<std::size_t>(worker)];
    const DeferredScatter::Work work = deferred_.begin(worker, groups_of(chunks_, chunk));
    double* sum = memory.zeroed_sum(chunk);
    const ChunkFields fields = memory.load(chunks_, c, at, f);
    for_each_run(
        chunks_, chunk, models,
        [&](const ElementGroup* groups, const GroupEdges* edges, int count, const ElementModel& model) {
          law_->step(groups, edges, count, model, scalar_, fields, sum, work.upper, *work.before,
                     memory.counts);
        });
    nodal_.add(chunks_, chunk, sum, f);
    deferred_.end(chunks_, c, worker, c + workers::count() >= chunks, *kernels_->shared, A);
  });
  nodal_.finish(chunks_, f);
  deferred_.finish(chunks_, *kernels_->shared, A);
  return collect_counts();
}

/// Sums kernel(chunk, fields, sums, counts) over the chunks: lane by lane within a chunk, then in the
/// order of the chunks.
template <class Kernel>
double ElementEvaluation::sum_over_elements(const BodyFields& at, const Kernel& kernel) {
  fit();
  workers::for_each(static_cast<int>(chunks_.chunks.size()), [&](int c, int worker) {
    const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
    ChunkMemory& memory = memory_[static_cast<std::size_t>(worker)];
    Line sums{};
    const ChunkFields fields = memory.load(chunks_, c, at);
    kernel(chunk, fields, sums.value, memory.counts);
    chunk_sums_[static_cast<std::size_t>(c)] = std::accumulate(sums.value, sums.value + 8, 0.0);
  });
  collect_counts();
  return std::accumulate(chunk_sums_.begin(), chunk_sums_.end(), 0.0);
}

double ElementEvaluation::energy(const ElementModels& models, const BodyFields& at) {
  return sum_over_elements(at, [&](const Chunk& chunk, const ChunkFields& fields, double* sums,
                                   LaneCounts& counts) {
    for_each_run(chunks_, chunk, models,
                 [&](const ElementGroup* groups, const GroupEdges*, int count, const ElementModel& model) {
                   law_->energy(groups, count, model, scalar_, fields, sums, counts);
                 });
  });
}

double ElementEvaluation::dissipated_power(const ElementModels& models, const BodyFields& at) {
  return sum_over_elements(at, [&](const Chunk& chunk, const ChunkFields& fields, double* sums, LaneCounts&) {
    for_each_run(chunks_, chunk, models,
                 [&](const ElementGroup* groups, const GroupEdges*, int count, const ElementModel& model) {
                   kernels_->shared->power(groups, count, model, fields, sums);
                 });
  });
}

std::size_t ElementEvaluation::scratch_bytes() const {
  std::size_t sum =
      nodal_.bytes() + matrix_.scratch_bytes() + deferred_.scratch_bytes() + bytes_of(chunk_sums_);
  for (const ChunkMemory& memory : memory_) sum += memory.bytes();
  return sum;
}

}  // namespace palpate::fem
