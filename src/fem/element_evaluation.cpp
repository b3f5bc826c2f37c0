#include "element_evaluation.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "corotated.h"
#include "palpate/core/error.h"
#include "palpate/core/polar.h"
#include "palpate/core/workers.h"

namespace palpate::fem {
namespace {

using Chunk = ElementChunks::Chunk;
using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
constexpr int kSumsInTask = 512;
constexpr int kFewChunks = 16;  // of a matrix that caches hold: to fill them with two chunks at a time costs more than waiting for it
constexpr int kSumsAhead = 6, kNodesAhead = 24;  // how long before they are used memory is asked for

void rotation_by_scalar(const double* F, double* R) {
  Eigen::Map<RowMajor> out(R);
  out = polar_decomposition(Eigen::Map<const RowMajor>(F)).R;
}

bool coupling_by_scalar(const ElementModel& model, const double* F, const double* R, double* C) {
  bool clamped = false;
  const Tangent tangent = model.warped ? Tangent::kWarped : model.projected ? Tangent::kProjected : Tangent::kExact;
  Eigen::Map<RowMajor> out(C);
  out = rotation_coupling(tangent, Eigen::Map<const RowMajor>(F), Eigen::Map<const RowMajor>(R), {model.mu, model.lambda}, clamped);
  return clamped;
}

constexpr ScalarPath kScalarPath{rotation_by_scalar, coupling_by_scalar};

double* numbers(auto& lines) { return lines.empty() ? nullptr : lines.front().value; }

/// Runs f(k) for k in [0, count), in tasks of kSumsInTask.
template <class F>
void for_each_sum(int count, F&& f) {
  workers::for_each((count + kSumsInTask - 1) / kSumsInTask, [&](int task, int) {
    for (int k = task * kSumsInTask; k < std::min(count, (task + 1) * kSumsInTask); ++k) f(k);
  });
}

/// Nine numbers summed over the contributions to shared edge k.
template <class Real>
void sum_blocks(const SharedSums& sums, int k, const std::vector<Real>& contributions, double* sum) {
  std::fill_n(sum, 9, 0.0);
  for (int p = sums.start[static_cast<std::size_t>(k)]; p < sums.start[static_cast<std::size_t>(k) + 1]; ++p) {
    const Real* block = contributions.data() + 9 * static_cast<std::size_t>(sums.entries[static_cast<std::size_t>(p)]);
    for (int c = 0; c < 9; ++c) sum[c] += block[c];
  }
}

void set_zero(const ChunkBlocks& blocks, int count) {
  std::fill_n(blocks.first, 8 * count, 0.0);
  std::fill_n(blocks.last, count, 0.0);
}

void keep_blocks(const ChunkBlocks& blocks, int begin, int end, double* to) {
  for (int k = begin; k < end; ++k, to += 9) {
    std::memcpy(to, blocks.first + 8 * k, 8 * sizeof(double));  // they never overlap: no call for sixty-four bytes
    to[8] = blocks.last[k];
  }
}

}  // namespace

ElementEvaluation::ElementEvaluation(const TetMesh& rest, const RestElements& elements, const std::vector<int>& material_of_element, bool with_lower)
    : chunks_(rest, elements, material_of_element), kernels_(&best_kernels()), with_lower_(with_lower) {
  shared_nodes_.resize((static_cast<std::size_t>(chunks_.shared_nodes.contributions()) + 1) / 2);
  chunk_sums_.resize(chunks_.chunks.size());
  fit_scratch();
}

void ElementEvaluation::fit_scratch() {
  const auto threads = static_cast<std::size_t>(workers::count());
  if (scratch_.size() >= threads) return;
  const auto nodes = static_cast<std::size_t>(chunks_.most_nodes) + 4;
  const std::size_t first = scratch_.size();
  scratch_.resize(threads);
  for (std::size_t s = first; s < threads; ++s)
    for (auto* field : {&scratch_[s].x, &scratch_[s].v, &scratch_[s].w, &scratch_[s].sum}) field->resize((nodes + 1) / 2);
}

void ElementEvaluation::fit_blocks() {
  fit_scratch();
  const auto nodes = static_cast<std::size_t>(chunks_.most_nodes) + 4, edges = static_cast<std::size_t>(chunks_.most_edges) + 1;
  for (Scratch& scratch : scratch_) {
    scratch.upper.resize(edges);
    scratch.upper_last.resize(edges);
    if (with_lower_) {
      scratch.lower.resize(edges);
      scratch.lower_last.resize(edges);
    }
    scratch.diagonal.resize(nodes);
    scratch.diagonal_last.resize(nodes);
  }
}

void ElementEvaluation::fit_leaving() {
  fit_scratch();
  const auto edges = static_cast<std::size_t>(chunks_.most_edges) + 1;
  const int turns = static_cast<int>(chunks_.chunks.size()) <= kFewChunks ? 1 : 2;
  for (Scratch& scratch : scratch_)
    for (int turn = 0; turn < turns; ++turn) {
      scratch.leaving[turn].resize(edges);
      scratch.leaving_last[turn].resize(edges);
    }
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
  chunks_.for_each_run(chunk, [&](const ElementChunks::Run& run) { f(chunks_.groups.data() + run.first_group, run.groups, models[static_cast<std::size_t>(run.material)]); });
}

/// Behind the nodes of the chunk stand the corners of the unit tetrahedron that fills up groups.
ChunkFields ElementEvaluation::load(const Chunk& chunk, const BodyFields& at, Scratch& scratch) const {
  const int* nodes = chunks_.nodes.data() + chunk.first_node;
  const auto copy = [&](const double* from, std::vector<Line>& lines, double unit, const double* more = nullptr) {
    double* to = numbers(lines);
    for (int n = 0; n < chunk.nodes; ++n) {
      if (n + kNodesAhead < chunk.nodes) __builtin_prefetch(from + 3 * static_cast<std::size_t>(nodes[n + kNodesAhead]));
      const double* p = from + 3 * static_cast<std::size_t>(nodes[n]);
      to[4 * n] = p[0];
      to[4 * n + 1] = p[1];
      to[4 * n + 2] = p[2];
      to[4 * n + 3] = 0.0;
    }
    for (int n = 0; more && n < chunk.nodes; ++n)
      for (int axis = 0; axis < 3; ++axis) to[4 * n + axis] += more[3 * static_cast<std::size_t>(nodes[n]) + static_cast<std::size_t>(axis)];
    std::fill_n(to + 4 * chunk.nodes, 16, 0.0);
    for (int axis = 0; axis < 3; ++axis) to[4 * (chunk.nodes + 1 + axis) + axis] = unit;
    return static_cast<const double*>(to);
  };
  ChunkFields out;
  out.x = copy(at.x, scratch.x, 1.0);
  if (at.v) out.v = copy(at.v, scratch.v, 0.0, at.dv);
  if (at.w) out.w = copy(at.w, scratch.w, 0.0);
  return out;
}

LaneCounts ElementEvaluation::add_nodal(NodalKernel kernel, const ElementModels& models, const BodyFields& at, double* out) {
  fit_scratch();
  workers::for_each(static_cast<int>(chunks_.chunks.size()), [&](int c, int worker) {
    const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
    Scratch& scratch = scratch_[static_cast<std::size_t>(worker)];
    const ChunkFields fields = load(chunk, at, scratch);
    double* sum = numbers(scratch.sum);
    std::fill_n(sum, 4 * (chunk.nodes + 4), 0.0);
    for_each_run(chunk, models, [&](const ElementGroup* groups, int count, const ElementModel& model) { kernel(groups, count, model, kScalarPath, fields, sum, scratch.counts); });
    flush_nodal(chunk, sum, out);
  });
  add_shared_nodes(out);
  return collect_counts();
}

/// A chunk's own sums go into `out`, the others aside.
void ElementEvaluation::flush_nodal(const Chunk& chunk, const double* sum, double* out) {
  const int* nodes = chunks_.nodes.data() + chunk.first_node;
  for (int n = 0; n < chunk.own_nodes; ++n) {
    if (n + kNodesAhead < chunk.own_nodes) __builtin_prefetch(out + 3 * static_cast<std::size_t>(nodes[n + kNodesAhead]));
    for (int axis = 0; axis < 3; ++axis) out[3 * static_cast<std::size_t>(nodes[n]) + static_cast<std::size_t>(axis)] += sum[4 * n + axis];
  }
  std::copy_n(sum + 4 * chunk.own_nodes, 4 * (chunk.nodes - chunk.own_nodes), numbers(shared_nodes_) + 4 * static_cast<std::size_t>(chunk.first_shared_node));
}

void ElementEvaluation::add_shared_nodes(double* out) const {
  const SharedSums& shared = chunks_.shared_nodes;
  for_each_sum(shared.count(), [&](int k) {
    double sum[3] = {0.0, 0.0, 0.0};
    for (int p = shared.start[static_cast<std::size_t>(k)]; p < shared.start[static_cast<std::size_t>(k) + 1]; ++p) {
      const double* part = shared_nodes_.front().value + 4 * static_cast<std::size_t>(shared.entries[static_cast<std::size_t>(p)]);
      for (int axis = 0; axis < 3; ++axis) sum[axis] += part[axis];
    }
    for (int axis = 0; axis < 3; ++axis) out[3 * static_cast<std::size_t>(shared.first[static_cast<std::size_t>(k)]) + static_cast<std::size_t>(axis)] += sum[axis];
  });
}

LaneCounts ElementEvaluation::add_force(const ElementModels& models, const BodyFields& at, double* f) { return add_nodal(kernels_->force, models, at, f); }
LaneCounts ElementEvaluation::add_step_force(const ElementModels& models, const BodyFields& at, double* f) { return add_nodal(kernels_->step_force, models, at, f); }
LaneCounts ElementEvaluation::apply_tangent(const ElementModels& models, const BodyFields& at, double* y) { return add_nodal(kernels_->apply, models, at, y); }

LaneCounts ElementEvaluation::add_tangent(const ElementModels& models, const BodyFields& at, int first_node, dynamics::BlockSparse& A) {
  fit_blocks();
  prepare(first_node, A);
  const bool symmetric = !models.front().by_position;
  PALPATE_CHECK(symmetric || with_lower_, "no room was set aside for an unsymmetric tangent");
  workers::for_each(static_cast<int>(chunks_.chunks.size()), [&](int c, int worker) {
    const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
    Scratch& scratch = scratch_[static_cast<std::size_t>(worker)];
    const ChunkBlocks upper{numbers(scratch.upper), scratch.upper_last.data()}, lower{numbers(scratch.lower), scratch.lower_last.data()};
    const ChunkBlocks diagonal{numbers(scratch.diagonal), scratch.diagonal_last.data()};
    set_zero(upper, chunk.edges + 1);
    if (!symmetric) set_zero(lower, chunk.edges + 1);
    const ChunkFields fields = load(chunk, at, scratch);
    for_each_run(chunk, models, [&](const ElementGroup* groups, int count, const ElementModel& model) { kernels_->tangent(groups, count, model, kScalarPath, fields, upper, lower, scratch.counts); });
    const BlockTargets targets{chunk.nodes, chunk.own_nodes, chunks_.row_start.data() + chunk.first_node, chunks_.row_own.data() + chunk.first_node,
                               chunks_.row_edges.data(), slots_.data(), chunk_diagonal_.data() + chunk.first_node};
    kernels_->flush(targets, upper, lower, symmetric, diagonal, A.values().data());
    const auto edge_place = 9 * static_cast<std::size_t>(chunk.first_shared_edge);
    keep_blocks(upper, chunk.own_edges, chunk.edges, shared_upper_.data() + edge_place);
    if (!symmetric) keep_blocks(lower, chunk.own_edges, chunk.edges, shared_lower_.data() + edge_place);
    keep_blocks(diagonal, chunk.own_nodes, chunk.nodes, shared_diagonal_.data() + 9 * static_cast<std::size_t>(chunk.first_shared_node));
  });
  add_shared_blocks(symmetric, A);
  return collect_counts();
}

void ElementEvaluation::add_shared_blocks(bool symmetric, dynamics::BlockSparse& A) const {
  const int edges = chunks_.shared_edges.count();
  for_each_sum(edges, [&](int k) {
    if (k + kSumsAhead < edges) fetch_sum<2>(k + kSumsAhead, shared_slots_.data(), shared_upper_.data(), A.values().data());
    double sum[9];
    sum_blocks(chunks_.shared_edges, k, shared_upper_, sum);
    double *above = A.block(shared_slots_[2 * static_cast<std::size_t>(k)]), *below = A.block(shared_slots_[2 * static_cast<std::size_t>(k) + 1]);
    for (int c = 0; c < 9; ++c) above[c] += sum[c];
    if (symmetric) {
      for (int c = 0; c < 9; ++c) below[c] += sum[c % 3 * 3 + c / 3];
    } else {
      sum_blocks(chunks_.shared_edges, k, shared_lower_, sum);
      for (int c = 0; c < 9; ++c) below[c] += sum[c];
    }
  });
  for_each_sum(chunks_.shared_nodes.count(), [&](int k) {
    double sum[9];
    sum_blocks(chunks_.shared_nodes, k, shared_diagonal_, sum);
    double* block = A.block(diagonal_[static_cast<std::size_t>(chunks_.shared_nodes.first[static_cast<std::size_t>(k)])]);
    for (int c = 0; c < 9; ++c) block[c] += sum[c];
  });
}

/// What the sum over shared edge k reads and writes lies scattered: asked for some sums before, it is there in time.
template <int kPlaces, class Real>
void ElementEvaluation::fetch_sum(int k, const std::int32_t* places, const Real* contributions, const Real* values) const {
  const auto edge = static_cast<std::size_t>(k);
  for (int p = chunks_.shared_edges.start[edge]; p < chunks_.shared_edges.start[edge + 1]; ++p) {
    const Real* block = contributions + 9 * static_cast<std::size_t>(chunks_.shared_edges.entries[static_cast<std::size_t>(p)]);
    __builtin_prefetch(block);
    __builtin_prefetch(block + 8);
  }
  for (std::size_t at = kPlaces * edge; at < kPlaces * (edge + 1); ++at) {
    const Real* place = values + 9 * static_cast<std::size_t>(places[at]);
    __builtin_prefetch(place);
    __builtin_prefetch(place + 8);
  }
}

LaneCounts ElementEvaluation::add_step(const ElementModels& models, const BodyFields& at, int first_node, double* f, dynamics::BalancedMatrix& A) {
  fit_leaving();
  prepare_places(first_node, A);
  PALPATE_CHECK(!models.front().by_position, "an unsymmetric tangent in a balanced matrix");
  const int chunks = static_cast<int>(chunks_.chunks.size());
  workers::for_each(chunks, [&](int c, int worker) {
    const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
    Scratch& scratch = scratch_[static_cast<std::size_t>(worker)];
    const ChunkBlocks upper{numbers(scratch.leaving[scratch.turn]), scratch.leaving_last[scratch.turn].data()};
    double* sum = numbers(scratch.sum);
    std::fill_n(sum, 4 * (chunk.nodes + 4), 0.0);
    const ChunkFields fields = load(chunk, at, scratch);
    LeavingBlocks& before = scratch.before;
    int groups_here = 0;
    chunks_.for_each_run(chunk, [&](const ElementChunks::Run& run) { groups_here += run.groups; });
    before.at_a_time = before.count / std::max(1, groups_here) + 1;
    for_each_run(chunk, models, [&](const ElementGroup* groups, int count, const ElementModel& model) { kernels_->step(groups, count, model, kScalarPath, fields, sum, upper, before, scratch.counts); });
    flush_nodal(chunk, sum, f);
    kernels_->leave(before, before.count);
    before = {upper, leaving_edges_.data() + chunk.first_edge, places_.data() + chunk.first_edge, A.values.data(),
              shared_single_.data() + 9 * static_cast<std::size_t>(chunk.first_shared_edge), chunk.own_edges, chunk.edges};
    if (chunks <= kFewChunks || c + workers::count() >= chunks)  // likely this thread's last
      kernels_->leave(before, before.count);
    else
      scratch.turn = 1 - scratch.turn;
  });
  for (Scratch& scratch : scratch_) {
    kernels_->leave(scratch.before, scratch.before.count);
    scratch.before = {};
  }
  add_shared_nodes(f);
  store_shared_blocks(A);
  return collect_counts();
}

void ElementEvaluation::store_shared_blocks(dynamics::BalancedMatrix& A) const {
  const int edges = chunks_.shared_edges.count();
  for_each_sum(edges, [&](int k) {
    if (k + kSumsAhead < edges) fetch_sum<1>(k + kSumsAhead, shared_places_.data(), shared_single_.data(), A.values.data());
    double sum[9];
    sum_blocks(chunks_.shared_edges, k, shared_single_, sum);
    float* to = A.values.data() + 9 * static_cast<std::size_t>(shared_places_[static_cast<std::size_t>(k)]);
    for (int c = 0; c < 9; ++c) to[c] = static_cast<float>(sum[c]);
  });
}

double ElementEvaluation::energy(const ElementModels& models, const BodyFields& at) {
  fit_scratch();
  workers::for_each(static_cast<int>(chunks_.chunks.size()), [&](int c, int worker) {
    const Chunk& chunk = chunks_.chunks[static_cast<std::size_t>(c)];
    Scratch& scratch = scratch_[static_cast<std::size_t>(worker)];
    Line sums{};
    const ChunkFields fields = load(chunk, at, scratch);
    for_each_run(chunk, models, [&](const ElementGroup* groups, int count, const ElementModel& model) { kernels_->energy(groups, count, model, kScalarPath, fields, sums.value, scratch.counts); });
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
    const ChunkFields fields = load(chunk, at, scratch);
    for_each_run(chunk, models, [&](const ElementGroup* groups, int count, const ElementModel& model) { kernels_->power(groups, count, model, fields, sums.value); });
    chunk_sums_[static_cast<std::size_t>(c)] = std::accumulate(sums.value, sums.value + 8, 0.0);
  });
  return std::accumulate(chunk_sums_.begin(), chunk_sums_.end(), 0.0);
}

}  // namespace palpate::fem
