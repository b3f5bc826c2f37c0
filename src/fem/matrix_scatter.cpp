#include "matrix_scatter.h"

#include <algorithm>
#include <cstring>

#include "nodal_reduction.h"
#include "palpate/core/error.h"
#include "shared_blocks.h"

namespace palpate::fem {
namespace {

using Chunk = ElementChunks::Chunk;

/// Copies blocks [begin, end) to `to`, nine numbers each.
void keep_blocks(const ChunkBlocks& blocks, int begin, int end, double* to) {
  for (int k = begin; k < end; ++k, to += 9) {
    // memcpy of a constant size without overlap is inlined: no call for sixty-four bytes
    std::memcpy(to, blocks.first + 8 * k, 8 * sizeof(double));
    to[8] = blocks.last[k];
  }
}

}  // namespace

void MatrixScatter::prepare(const ElementChunks& chunks, int first_node, const dynamics::BlockSparse& A) {
  if (A.pattern_version() == pattern_version_ && first_node == first_node_) return;
  const auto slot = [&](int i, int j) {
    const int found = A.slot(first_node + i, first_node + j);
    PALPATE_CHECK(found >= 0, "nodes {} and {} are not in the pattern", first_node + i, first_node + j);
    return static_cast<std::int32_t>(found);
  };
  slots_.resize(chunks.row_edges.size());
  chunk_diagonal_.resize(chunks.nodes.size());
  diagonal_.resize(static_cast<std::size_t>(chunks.node_count()));
  for (std::size_t i = 0; i < diagonal_.size(); ++i)
    diagonal_[i] = slot(static_cast<int>(i), static_cast<int>(i));
  for (std::size_t n = 0; n < chunks.nodes.size(); ++n)
    chunk_diagonal_[n] = diagonal_[static_cast<std::size_t>(chunks.nodes[n])];
  for (const Chunk& chunk : chunks.chunks)
    for (int n = chunk.first_node; n < chunk.first_node + chunk.nodes; ++n)
      for (int p = chunks.row_start[static_cast<std::size_t>(n)];
           p < chunks.row_start[static_cast<std::size_t>(n) + 1]; ++p) {
        const std::uint32_t entry = chunks.row_edges[static_cast<std::size_t>(p)];
        const std::size_t other =
            2 * (static_cast<std::size_t>(chunk.first_edge) + entry / 2) + (1 - entry % 2);
        slots_[static_cast<std::size_t>(p)] =
            slot(chunks.nodes[static_cast<std::size_t>(n)],
                 chunks.nodes[static_cast<std::size_t>(chunk.first_node + chunks.ends[other])]);
      }
  find_both_sides(chunks.shared_edges, slot, shared_slots_);
  find_unwritten_slots(chunks, first_node, A);
  prefer_huge_pages(slots_);
  pattern_version_ = A.pattern_version();
  first_node_ = first_node;
}

void MatrixScatter::find_unwritten_slots(const ElementChunks& chunks, int first_node,
                                         const dynamics::BlockSparse& A) {
  const auto row = [&](int node) { return A.row_start()[static_cast<std::size_t>(first_node + node)]; };
  const int first = row(0), end = row(chunks.node_count());
  std::vector<char> filled(static_cast<std::size_t>(end - first), 0);
  for (const auto* slots : {&slots_, &chunk_diagonal_})
    for (std::int32_t slot : *slots) filled[static_cast<std::size_t>(slot - first)] = 1;
  bare_slots_.clear();
  for (int slot = first; slot < end; ++slot)
    if (!filled[static_cast<std::size_t>(slot - first)]) bare_slots_.push_back(slot);
}

void MatrixScatter::fit(const ElementChunks& chunks, bool with_lower) {
  if (in_order()) return;
  const auto edges = static_cast<std::size_t>(chunks.shared_edges.contributions());
  fit_contributions(shared_upper_, edges);
  if (with_lower) fit_contributions(shared_lower_, edges);
  fit_contributions(shared_diagonal_, static_cast<std::size_t>(chunks.shared_nodes.contributions()));
}

void MatrixScatter::clear_bare_slots(dynamics::BlockSparse& A) const {
  for (std::int32_t slot : bare_slots_) std::fill_n(A.block(slot), 9, 0.0);
}

void MatrixScatter::add(const ElementChunks& chunks, const Chunk& chunk, const SharedKernels& kernels,
                        ChunkMemory& memory, bool symmetric, bool stored, dynamics::BlockSparse& A) {
  const ChunkBlocks upper = memory.upper.blocks(), lower = memory.lower.blocks(),
                    diagonal = memory.diagonal.blocks();
  const BlockTargets targets{chunk.nodes,
                             chunk.owned_nodes,
                             chunks.row_start.data() + chunk.first_node,
                             chunks.row_owned.data() + chunk.first_node,
                             chunks.row_edges.data(),
                             slots_.data(),
                             chunk_diagonal_.data() + chunk.first_node,
                             in_order(),
                             stored};
  kernels.flush(targets, upper, lower, symmetric, diagonal, A.values().data());
  if (in_order()) return;
  const auto first_edge = 9 * static_cast<std::size_t>(chunk.first_shared_edge);
  keep_blocks(upper, chunk.owned_edges, chunk.edges, shared_upper_.data() + first_edge);
  if (!symmetric) keep_blocks(lower, chunk.owned_edges, chunk.edges, shared_lower_.data() + first_edge);
  keep_blocks(diagonal, chunk.owned_nodes, chunk.nodes,
              shared_diagonal_.data() + 9 * static_cast<std::size_t>(chunk.first_shared_node));
}

void MatrixScatter::finish(const ElementChunks& chunks, bool symmetric, dynamics::BlockSparse& A) const {
  if (in_order()) return;
  const SharedSums& shared = chunks.shared_edges;
  const int edges = shared.count();
  const auto slot = [&](int k, int side) { return shared_slots_[static_cast<std::size_t>(2 * k + side)]; };
  for_each_sum(edges, [&](int k) {
    if (k + kSumsAhead < edges) {
      prefetch_contributions(shared, k + kSumsAhead, shared_upper_.data());
      for (int side = 0; side < 2; ++side) prefetch_block(A.block(slot(k + kSumsAhead, side)));
    }
    add_contributions(shared, k, shared_upper_, A.block(slot(k, 0)));
    add_contributions(shared, k, symmetric ? shared_upper_ : shared_lower_, A.block(slot(k, 1)), symmetric);
  });
  const SharedSums& nodes = chunks.shared_nodes;
  for_each_sum(nodes.count(), [&](int k) {
    const auto node = static_cast<std::size_t>(nodes.first[static_cast<std::size_t>(k)]);
    add_contributions(nodes, k, shared_diagonal_, A.block(diagonal_[node]));
  });
}

std::size_t MatrixScatter::map_bytes() const {
  return bytes_of(slots_) + bytes_of(bare_slots_) + bytes_of(chunk_diagonal_) + bytes_of(shared_slots_) +
         bytes_of(diagonal_);
}

std::size_t MatrixScatter::scratch_bytes() const {
  return bytes_of(shared_upper_) + bytes_of(shared_lower_) + bytes_of(shared_diagonal_);
}

}  // namespace palpate::fem
