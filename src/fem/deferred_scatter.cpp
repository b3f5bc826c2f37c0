#include "deferred_scatter.h"

#include <algorithm>
#include <utility>

#include "core/counters.h"
#include "nodal_reduction.h"
#include "palpate/core/error.h"
#include "shared_blocks.h"

namespace palpate::fem {
namespace {

using Chunk = ElementChunks::Chunk;
// Number of chunks up to which one buffer per thread is used: a matrix of so few chunks stays in the caches,
// and a second buffer would displace more than the overlap gains.
constexpr int kFewChunks = 16;

}  // namespace

int DeferredScatter::buffers(const ElementChunks& chunks) {
  return static_cast<int>(chunks.chunks.size()) <= kFewChunks ? 1 : 2;
}

void DeferredScatter::prepare(const ElementChunks& chunks, int first_node,
                              const dynamics::ZeroRowSumMatrix& A) {
  const auto is_current = [&] { return map().key == A.slot_map_key && map().first_node == first_node; };
  if (is_current()) return;
  current_ = 1 - current_;
  if (!is_current()) make(chunks, first_node, A, maps_[current_]);
}

/// Slots are sorted, so that the matrix is written in memory order.
void DeferredScatter::make(const ElementChunks& chunks, int first_node, const dynamics::ZeroRowSumMatrix& A,
                           Map& map) {
  counters::count("fem.scatter_map");
  const auto slot = [&](int i, int j) {
    const int found = A.pattern->slot(first_node + i, first_node + j);
    PALPATE_CHECK(found >= 0, "nodes {} and {} are not in the pattern", first_node + i, first_node + j);
    return A.slot_map[static_cast<std::size_t>(found)];
  };
  const auto slot_of = [&](const Chunk& chunk, int edge) {
    const std::uint16_t* ends = chunks.ends.data() + 2 * static_cast<std::size_t>(chunk.first_edge + edge);
    return slot(chunks.nodes[static_cast<std::size_t>(chunk.first_node + ends[0])],
                chunks.nodes[static_cast<std::size_t>(chunk.first_node + ends[1])]);
  };
  map.slots.assign(chunks.ends.size() / 2, -1);
  map.edges.assign(map.slots.size(), 0);
  std::vector<std::pair<std::int32_t, std::uint16_t>> owned;
  for (const Chunk& chunk : chunks.chunks) {
    owned.clear();
    for (int k = 0; k < chunk.owned_edges; ++k) owned.emplace_back(slot_of(chunk, k), k);
    std::sort(owned.begin(), owned.end());
    for (std::size_t k = 0; k < owned.size(); ++k) {
      map.slots[static_cast<std::size_t>(chunk.first_edge) + k] = owned[k].first;
      map.edges[static_cast<std::size_t>(chunk.first_edge) + k] = owned[k].second;
    }
    for (int k = chunk.owned_edges; k < chunk.edges; ++k) {
      map.slots[static_cast<std::size_t>(chunk.first_edge + k)] = slot_of(chunk, k);
      map.edges[static_cast<std::size_t>(chunk.first_edge + k)] = static_cast<std::uint16_t>(k);
    }
  }
  map.shared_slots.clear();
  for (int k = 0; k < chunks.shared_edges.count(); ++k)
    map.shared_slots.push_back({slot(chunks.shared_edges.first[static_cast<std::size_t>(k)],
                                     chunks.shared_edges.second[static_cast<std::size_t>(k)]),
                                k});
  std::sort(map.shared_slots.begin(), map.shared_slots.end(),
            [](const SharedSlot& a, const SharedSlot& b) { return a.slot < b.slot; });
  prefer_huge_pages(map.slots);
  map.key = A.slot_map_key;
  map.first_node = first_node;
}

void DeferredScatter::fit(const ElementChunks& chunks, int threads) {
  if (static_cast<int>(buffers_.size()) < threads) buffers_.resize(static_cast<std::size_t>(threads));
  for (Buffers& b : buffers_)
    for (int k = 0; k < buffers(chunks); ++k)
      b.blocks[k].resize(static_cast<std::size_t>(chunks.most_edges) + 1);
  if (!in_order()) fit_contributions(shared_, static_cast<std::size_t>(chunks.shared_edges.contributions()));
}

DeferredScatter::Work DeferredScatter::begin(int thread, int groups) {
  Buffers& b = buffers_[static_cast<std::size_t>(thread)];
  b.before.batch = b.before.count / std::max(1, groups) + 1;
  return {b.blocks[b.current].blocks(), &b.before};
}

void DeferredScatter::end(const ElementChunks& chunks, int c, int thread, bool last,
                          const SharedKernels& kernels, dynamics::ZeroRowSumMatrix& A) {
  const Chunk& chunk = chunks.chunks[static_cast<std::size_t>(c)];
  Buffers& b = buffers_[static_cast<std::size_t>(thread)];
  kernels.scatter(b.before, b.before.count);
  b.before = {b.blocks[b.current].blocks(),
              map().edges.data() + chunk.first_edge,
              map().slots.data() + chunk.first_edge,
              A.values.data(),
              in_order() ? nullptr : shared_.data() + 9 * static_cast<std::size_t>(chunk.first_shared_edge),
              chunk.owned_edges,
              chunk.edges};
  if (buffers(chunks) == 1 || last)
    kernels.scatter(b.before, b.before.count);
  else
    b.current = 1 - b.current;
}

void DeferredScatter::finish(const ElementChunks& chunks, const SharedKernels& kernels,
                             dynamics::ZeroRowSumMatrix& A) {
  for (Buffers& b : buffers_) {
    kernels.scatter(b.before, b.before.count);
    b.before = {};
  }
  if (in_order()) return;
  const SharedSums& shared = chunks.shared_edges;
  const int edges = shared.count();
  for_each_sum(edges, [&](int k) {
    if (k + kSumsAhead < edges) {
      const SharedSlot& next = map().shared_slots[static_cast<std::size_t>(k + kSumsAhead)];
      prefetch_contributions(shared, next.edge, shared_.data());
      prefetch_block(A.values.data() + 9 * static_cast<std::size_t>(next.slot));
    }
    const auto [slot, edge] = map().shared_slots[static_cast<std::size_t>(k)];
    add_contributions(shared, edge, shared_, A.values.data() + 9 * static_cast<std::size_t>(slot));
  });
}

std::size_t DeferredScatter::map_bytes() const {
  std::size_t sum = 0;
  for (const Map& map : maps_) sum += bytes_of(map.slots) + bytes_of(map.edges) + bytes_of(map.shared_slots);
  return sum;
}

std::size_t DeferredScatter::scratch_bytes() const {
  std::size_t sum = bytes_of(shared_);
  for (const Buffers& b : buffers_) sum += b.blocks[0].bytes() + b.blocks[1].bytes();
  return sum;
}

}  // namespace palpate::fem
