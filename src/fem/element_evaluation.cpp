#include "element_evaluation.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "palpate/core/error.h"
#include "palpate/core/huge_pages.h"
#include "palpate/core/workers.h"

namespace palpate::fem {
namespace {

using Chunk = ElementChunks::Chunk;
constexpr int kSumsInTask = 512;
// of a matrix that caches hold: to fill them with two chunks at a time costs more than waiting for it
constexpr int kFewChunks = 16;
constexpr int kSumsAhead = 6, kNodesAhead = 24;  // how long before they are used memory is asked for

double* numbers(auto& lines) { return lines.empty() ? nullptr : lines.front().value; }

/// Runs f(k) for k in [0, count), in tasks of kSumsInTask.
template <class F>
void for_each_sum(int count, F&& f) {
  workers::for_each((count + kSumsInTask - 1) / kSumsInTask, [&](int task, int) {
    for (int k = task * kSumsInTask; k < std::min(count, (task + 1) * kSumsInTask); ++k) f(k);
  });
}

/// to += the contributions to late node or edge k, nine numbers each, one after the other; of a transposed
/// block where `turned`.
template <class Real>
void add_contributions(const LateSums& sums, int k, const std::vector<Real>& contributions, Real* to,
                       bool turned = false) {
  for (int p = sums.start[static_cast<std::size_t>(k)]; p < sums.start[static_cast<std::size_t>(k) + 1];
       ++p) {
    const Real* block =
        contributions.data() + 9 * static_cast<std::size_t>(sums.entries[static_cast<std::size_t>(p)]);
    for (int c = 0; c < 9; ++c) to[c] += block[turned ? c % 3 * 3 + c / 3 : c];
  }
}

// What the sum over a late edge reads and writes lies scattered: asked for some sums before, it is there in
// time.
template <class Real>
void fetch_block(const Real* block) {
  __builtin_prefetch(block);
  __builtin_prefetch(block + 8);
}
template <class Real>
void fetch_contributions(const LateSums& sums, int k, const Real* contributions) {
  for (int p = sums.start[static_cast<std::size_t>(k)]; p < sums.start[static_cast<std::size_t>(k) + 1]; ++p)
    fetch_block(contributions + 9 * static_cast<std::size_t>(sums.entries[static_cast<std::size_t>(p)]));
}

template <class Real>
void fit_late(std::vector<Real>& blocks, std::size_t count) {
  if (blocks.size() == 9 * count) return;
  blocks.resize(9 * count);
  prefer_huge_pages(blocks);
}

void set_zero(const ChunkBlocks& blocks, int count) {
  std::fill_n(blocks.first, 8 * count, 0.0);
  std::fill_n(blocks.last, count, 0.0);
}

void keep_blocks(const ChunkBlocks& blocks, int begin, int end, double* to) {
  for (int k = begin; k < end; ++k, to += 9) {
    // they never overlap: no call for sixty-four bytes
    std::memcpy(to, blocks.first + 8 * k, 8 * sizeof(double));
    to[8] = blocks.last[k];
  }
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
  fit_scratch();
}

void ElementEvaluation::fit_scratch() {
  if (!in_order()) late_nodes_.resize((static_cast<std::size_t>(chunks_.late_nodes.contributions()) + 1) / 2);
  const auto threads = static_cast<std::size_t>(workers::count());
  if (scratch_.size() >= threads) return;
  const auto nodes = static_cast<std::size_t>(chunks_.most_nodes) + 4;
  const std::size_t first = scratch_.size();
  scratch_.resize(threads);
  for (std::size_t s = first; s < threads; ++s)
    for (auto* field : {&scratch_[s].x, &scratch_[s].v, &scratch_[s].w, &scratch_[s].sum})
      field->resize((nodes + 1) / 2);
}

int ElementEvaluation::turns() const { return static_cast<int>(chunks_.chunks.size()) <= kFewChunks ? 1 : 2; }

void ElementEvaluation::BlockMemory::resize(std::size_t count) {
  first.resize(count);
  last.resize(count);
}
ChunkBlocks ElementEvaluation::BlockMemory::blocks() { return {numbers(first), last.data()}; }

void ElementEvaluation::fit_blocks() {
  fit_scratch();
  const auto nodes = static_cast<std::size_t>(chunks_.most_nodes) + 4,
             edges = static_cast<std::size_t>(chunks_.most_edges) + 1;
  for (Scratch& scratch : scratch_) {
    scratch.upper.resize(edges);
    if (with_lower_) scratch.lower.resize(edges);
    scratch.diagonal.resize(nodes);
  }
  if (in_order()) return;
  const auto late_edges = static_cast<std::size_t>(chunks_.late_edges.contributions());
  fit_late(late_upper_, late_edges);
  if (with_lower_) fit_late(late_lower_, late_edges);
  fit_late(late_diagonal_, static_cast<std::size_t>(chunks_.late_nodes.contributions()));
}

void ElementEvaluation::fit_leaving() {
  fit_scratch();
  for (Scratch& scratch : scratch_)
    for (int turn = 0; turn < turns(); ++turn)
      scratch.leaving[turn].resize(static_cast<std::size_t>(chunks_.most_edges) + 1);
  if (!in_order()) fit_late(late_single_, static_cast<std::size_t>(chunks_.late_edges.contributions()));
}

LaneCounts ElementEvaluation::collect_counts() {
  LaneCounts sum;
  for (Scratch& scratch : scratch_) {
    sum.inverted += scratch.counts.inverted;
    sum.clamped += scratch.counts.clamped;
    sum.by_scalar += scratch.counts.by_scalar;
    scratch.counts = {};
  }
  return sum;
}

/// Runs f(groups, count, model) for each material of a chunk.
template <class F>
void ElementEvaluation::for_each_run(const Chunk& chunk, const ElementModels& models, F&& f) const {
  chunks_.for_each_run(chunk, [&](const ElementChunks::Run& run) {
    f(chunks_.groups.data() + run.first_group, run.groups, models[static_cast<std::size_t>(run.material)]);
  });
}

/// Runs f(groups, edges, count, model) for each material of a chunk.
template <class F>
void ElementEvaluation::for_each_run_with_edges(const Chunk& chunk, const ElementModels& models,
                                                F&& f) const {
  chunks_.for_each_run(chunk, [&](const ElementChunks::Run& run) {
    f(chunks_.groups.data() + run.first_group, chunks_.edges.data() + run.first_group, run.groups,
      models[static_cast<std::size_t>(run.material)]);
  });
}

int ElementEvaluation::groups_of(const Chunk& chunk) const {
  int sum = 0;
  chunks_.for_each_run(chunk, [&](const ElementChunks::Run& run) { sum += run.groups; });
  return sum;
}

/// What the thread that has chunk c is likely to need next; the kernels ask for it while they work.
ComingNodes ElementEvaluation::coming_nodes(int c, const BodyFields& at, const double* out) const {
  const auto next = static_cast<std::size_t>(c + workers::count());
  if (next >= chunks_.chunks.size()) return {};
  const Chunk& chunk = chunks_.chunks[next];
  ComingNodes coming;
  coming.nodes = chunks_.nodes.data() + chunk.first_node;
  coming.count = chunk.nodes;
  coming.at_a_time = chunk.nodes / std::max(1, groups_of(chunks_.chunks[static_cast<std::size_t>(c)])) + 1;
  for (const double* field : {at.x, at.v, at.w, at.dv, out})
    if (field) coming.fields[coming.field_count++] = field;
  return coming;
}

/// Behind the nodes of the chunk stand the corners of the unit tetrahedron that fills up groups.
/// @param out  what is added to when the chunk is done
ChunkFields ElementEvaluation::load(int c, const BodyFields& at, Scratch& scratch, const double* out) const {
  const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
  const int* nodes = chunks_.nodes.data() + chunk.first_node;
  const auto copy = [&](const double* from, std::vector<Line>& lines, double unit,
                        const double* more = nullptr) {
    double* to = numbers(lines);
    for (int n = 0; n < chunk.nodes; ++n) {
      if (n + kNodesAhead < chunk.nodes)
        __builtin_prefetch(from + 3 * static_cast<std::size_t>(nodes[n + kNodesAhead]));
      const double* p = from + 3 * static_cast<std::size_t>(nodes[n]);
      to[4 * n] = p[0];
      to[4 * n + 1] = p[1];
      to[4 * n + 2] = p[2];
      to[4 * n + 3] = 0.0;
    }
    for (int n = 0; more && n < chunk.nodes; ++n)
      for (int axis = 0; axis < 3; ++axis)
        to[4 * n + axis] += more[3 * static_cast<std::size_t>(nodes[n]) + static_cast<std::size_t>(axis)];
    std::fill_n(to + 4 * chunk.nodes, 16, 0.0);
    for (int axis = 0; axis < 3; ++axis) to[4 * (chunk.nodes + 1 + axis) + axis] = unit;
    return static_cast<const double*>(to);
  };
  ChunkFields fields;
  fields.x = copy(at.x, scratch.x, 1.0);
  if (at.v) fields.v = copy(at.v, scratch.v, 0.0, at.dv);
  if (at.w) fields.w = copy(at.w, scratch.w, 0.0);
  scratch.coming = coming_nodes(c, at, out);
  fields.coming = &scratch.coming;
  return fields;
}

LaneCounts ElementEvaluation::add_nodal(NodalKernel kernel, const ElementModels& models, const BodyFields& at,
                                        double* out) {
  fit_scratch();
  workers::for_each(static_cast<int>(chunks_.chunks.size()), [&](int c, int worker) {
    const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
    Scratch& scratch = scratch_[static_cast<std::size_t>(worker)];
    const ChunkFields fields = load(c, at, scratch, out);
    double* sum = numbers(scratch.sum);
    std::fill_n(sum, 4 * (chunk.nodes + 4), 0.0);
    for_each_run(chunk, models, [&](const ElementGroup* groups, int count, const ElementModel& model) {
      kernel(groups, count, model, scalar_, fields, sum, scratch.counts);
    });
    flush_nodal(chunk, sum, out);
  });
  add_late_nodes(out);
  return collect_counts();
}

/// What is late may be added at once: what is not in order adds one share after the other as well, for the
/// same sums to the last bit.
bool ElementEvaluation::in_order() const { return workers::count() == 1; }

/// A chunk's own sums go into `out`, the late ones aside.
void ElementEvaluation::flush_nodal(const Chunk& chunk, const double* sum, double* out) {
  const int* nodes = chunks_.nodes.data() + chunk.first_node;
  const int direct = in_order() ? chunk.nodes : chunk.own_nodes;
  for (int n = 0; n < direct; ++n) {
    if (n + kNodesAhead < direct)
      __builtin_prefetch(out + 3 * static_cast<std::size_t>(nodes[n + kNodesAhead]));
    for (int axis = 0; axis < 3; ++axis)
      out[3 * static_cast<std::size_t>(nodes[n]) + static_cast<std::size_t>(axis)] += sum[4 * n + axis];
  }
  if (direct < chunk.nodes)
    std::copy_n(sum + 4 * direct, 4 * (chunk.nodes - direct),
                numbers(late_nodes_) + 4 * static_cast<std::size_t>(chunk.first_late_node));
}

void ElementEvaluation::add_late_nodes(double* out) const {
  if (in_order()) return;
  const LateSums& late = chunks_.late_nodes;
  for_each_sum(late.count(), [&](int k) {
    double* to = out + 3 * static_cast<std::size_t>(late.first[static_cast<std::size_t>(k)]);
    for (int p = late.start[static_cast<std::size_t>(k)]; p < late.start[static_cast<std::size_t>(k) + 1];
         ++p) {
      const double* part =
          late_nodes_.front().value + 4 * static_cast<std::size_t>(late.entries[static_cast<std::size_t>(p)]);
      for (int axis = 0; axis < 3; ++axis) to[axis] += part[axis];
    }
  });
}

LaneCounts ElementEvaluation::add_force(const ElementModels& models, const BodyFields& at, double* f) {
  return add_nodal(law_->force, models, at, f);
}
LaneCounts ElementEvaluation::add_step_force(const ElementModels& models, const BodyFields& at, double* f) {
  return add_nodal(law_->step_force, models, at, f);
}
LaneCounts ElementEvaluation::apply_tangent(const ElementModels& models, const BodyFields& at, double* y) {
  return add_nodal(law_->apply, models, at, y);
}

LaneCounts ElementEvaluation::store_tangent(const ElementModels& models, const BodyFields& at, int first_node,
                                            dynamics::BlockSparse& A) {
  prepare(first_node, A);
  for (std::int32_t slot : bare_slots_) std::fill_n(A.block(slot), 9, 0.0);
  return tangent(models, at, first_node, A, true);
}

LaneCounts ElementEvaluation::tangent(const ElementModels& models, const BodyFields& at, int first_node,
                                      dynamics::BlockSparse& A, bool stored) {
  fit_blocks();
  prepare(first_node, A);
  const bool symmetric = !models.front().by_position;
  PALPATE_CHECK(symmetric || with_lower_, "no room was set aside for an unsymmetric tangent");
  workers::for_each(static_cast<int>(chunks_.chunks.size()), [&](int c, int worker) {
    const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
    Scratch& scratch = scratch_[static_cast<std::size_t>(worker)];
    const ChunkBlocks upper = scratch.upper.blocks(), lower = scratch.lower.blocks(),
                      diagonal = scratch.diagonal.blocks();
    set_zero(upper, chunk.edges + 1);
    if (!symmetric) set_zero(lower, chunk.edges + 1);
    ChunkFields fields = load(c, at, scratch);
    scratch.rows = {chunks_.nodes.data() + chunk.first_node, A.row_start().data() + first_node,
                    A.values().data(), in_order() ? chunk.nodes : chunk.own_nodes};
    fields.rows = &scratch.rows;
    for_each_run_with_edges(
        chunk, models,
        [&](const ElementGroup* groups, const GroupEdges* edges, int count, const ElementModel& model) {
          law_->tangent(groups, edges, count, model, scalar_, fields, upper, lower, scratch.counts);
        });
    const BlockTargets targets{chunk.nodes,
                               chunk.own_nodes,
                               chunks_.row_start.data() + chunk.first_node,
                               chunks_.row_own.data() + chunk.first_node,
                               chunks_.row_edges.data(),
                               slots_.data(),
                               chunk_diagonal_.data() + chunk.first_node,
                               in_order(),
                               stored};
    kernels_->shared->flush(targets, upper, lower, symmetric, diagonal, A.values().data());
    if (in_order()) return;
    const auto edge_place = 9 * static_cast<std::size_t>(chunk.first_late_edge);
    keep_blocks(upper, chunk.own_edges, chunk.edges, late_upper_.data() + edge_place);
    if (!symmetric) keep_blocks(lower, chunk.own_edges, chunk.edges, late_lower_.data() + edge_place);
    keep_blocks(diagonal, chunk.own_nodes, chunk.nodes,
                late_diagonal_.data() + 9 * static_cast<std::size_t>(chunk.first_late_node));
  });
  add_late_blocks(symmetric, A);
  return collect_counts();
}

void ElementEvaluation::add_late_blocks(bool symmetric, dynamics::BlockSparse& A) const {
  if (in_order()) return;
  const LateSums& late = chunks_.late_edges;
  const int edges = late.count();
  const auto slot = [&](int k, int side) { return late_slots_[static_cast<std::size_t>(2 * k + side)]; };
  for_each_sum(edges, [&](int k) {
    if (k + kSumsAhead < edges) {
      fetch_contributions(late, k + kSumsAhead, late_upper_.data());
      for (int side = 0; side < 2; ++side) fetch_block(A.block(slot(k + kSumsAhead, side)));
    }
    add_contributions(late, k, late_upper_, A.block(slot(k, 0)));
    add_contributions(late, k, symmetric ? late_upper_ : late_lower_, A.block(slot(k, 1)), symmetric);
  });
  for_each_sum(chunks_.late_nodes.count(), [&](int k) {
    add_contributions(
        chunks_.late_nodes, k, late_diagonal_,
        A.block(diagonal_[static_cast<std::size_t>(chunks_.late_nodes.first[static_cast<std::size_t>(k)])]));
  });
}

LaneCounts ElementEvaluation::add_step(const ElementModels& models, const BodyFields& at, int first_node,
                                       double* f, dynamics::BalancedMatrix& A) {
  fit_leaving();
  prepare_places(first_node, A);
  PALPATE_CHECK(!models.front().by_position, "an unsymmetric tangent in a balanced matrix");
  const int chunks = static_cast<int>(chunks_.chunks.size());
  workers::for_each(chunks, [&](int c, int worker) {
    const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
    Scratch& scratch = scratch_[static_cast<std::size_t>(worker)];
    const ChunkBlocks upper = scratch.leaving[scratch.turn].blocks();
    double* sum = numbers(scratch.sum);
    std::fill_n(sum, 4 * (chunk.nodes + 4), 0.0);
    const ChunkFields fields = load(c, at, scratch, f);
    LeavingBlocks& before = scratch.before;
    before.at_a_time = before.count / std::max(1, groups_of(chunk)) + 1;
    for_each_run_with_edges(
        chunk, models,
        [&](const ElementGroup* groups, const GroupEdges* edges, int count, const ElementModel& model) {
          law_->step(groups, edges, count, model, scalar_, fields, sum, upper, before, scratch.counts);
        });
    flush_nodal(chunk, sum, f);
    kernels_->shared->leave(before, before.count);
    before = {
        upper,
        leaving_edges_.data() + chunk.first_edge,
        places_.data() + chunk.first_edge,
        A.values.data(),
        in_order() ? nullptr : late_single_.data() + 9 * static_cast<std::size_t>(chunk.first_late_edge),
        chunk.own_edges,
        chunk.edges};
    if (turns() == 1 || c + workers::count() >= chunks)  // likely this thread's last
      kernels_->shared->leave(before, before.count);
    else
      scratch.turn = 1 - scratch.turn;
  });
  for (Scratch& scratch : scratch_) {
    kernels_->shared->leave(scratch.before, scratch.before.count);
    scratch.before = {};
  }
  add_late_nodes(f);
  add_late_blocks(A);
  return collect_counts();
}

void ElementEvaluation::add_late_blocks(dynamics::BalancedMatrix& A) const {
  if (in_order()) return;
  const LateSums& late = chunks_.late_edges;
  const int edges = late.count();
  for_each_sum(edges, [&](int k) {
    if (k + kSumsAhead < edges) {
      const LatePlace& coming = late_places_[static_cast<std::size_t>(k + kSumsAhead)];
      fetch_contributions(late, coming.edge, late_single_.data());
      fetch_block(A.values.data() + 9 * static_cast<std::size_t>(coming.place));
    }
    const auto [place, edge] = late_places_[static_cast<std::size_t>(k)];
    add_contributions(late, edge, late_single_, A.values.data() + 9 * static_cast<std::size_t>(place));
  });
}

double ElementEvaluation::energy(const ElementModels& models, const BodyFields& at) {
  fit_scratch();
  workers::for_each(static_cast<int>(chunks_.chunks.size()), [&](int c, int worker) {
    const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
    Scratch& scratch = scratch_[static_cast<std::size_t>(worker)];
    Line sums{};
    const ChunkFields fields = load(c, at, scratch);
    for_each_run(chunk, models, [&](const ElementGroup* groups, int count, const ElementModel& model) {
      law_->energy(groups, count, model, scalar_, fields, sums.value, scratch.counts);
    });
    chunk_sums_[static_cast<std::size_t>(c)] = std::accumulate(sums.value, sums.value + 8, 0.0);
  });
  collect_counts();
  return std::accumulate(chunk_sums_.begin(), chunk_sums_.end(), 0.0);
}

double ElementEvaluation::dissipated_power(const ElementModels& models, const BodyFields& at) {
  fit_scratch();
  workers::for_each(static_cast<int>(chunks_.chunks.size()), [&](int c, int worker) {
    const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
    Scratch& scratch = scratch_[static_cast<std::size_t>(worker)];
    Line sums{};
    const ChunkFields fields = load(c, at, scratch);
    for_each_run(chunk, models, [&](const ElementGroup* groups, int count, const ElementModel& model) {
      kernels_->shared->power(groups, count, model, fields, sums.value);
    });
    chunk_sums_[static_cast<std::size_t>(c)] = std::accumulate(sums.value, sums.value + 8, 0.0);
  });
  return std::accumulate(chunk_sums_.begin(), chunk_sums_.end(), 0.0);
}

}  // namespace palpate::fem
