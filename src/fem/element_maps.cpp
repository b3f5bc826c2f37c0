// Where the blocks of an ElementEvaluation go in a matrix, and what its memory comes to.
#include <algorithm>

#include "element_evaluation.h"
#include "palpate/core/error.h"
#include "palpate/core/huge_pages.h"

namespace palpate::fem {
namespace {

using Chunk = ElementChunks::Chunk;

template <class T>
std::size_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

std::int32_t slot_of(const dynamics::BlockSparse& A, int i, int j) {
  const int found = A.slot(i, j);
  PALPATE_CHECK(found >= 0, "nodes {} and {} are not in the pattern", i, j);
  return static_cast<std::int32_t>(found);
}

/// at(i, j) and at(j, i) of each edge that chunks share.
template <class At>
void find_both_sides(const LateSums& edges, At&& at, std::vector<std::int32_t>& sides) {
  sides.resize(2 * edges.first.size());
  for (std::size_t k = 0; k < edges.first.size(); ++k) {
    sides[2 * k] = at(edges.first[k], edges.second[k]);
    sides[2 * k + 1] = at(edges.second[k], edges.first[k]);
  }
}

}  // namespace

void ElementEvaluation::prepare(int first_node, const dynamics::BlockSparse& A) {
  if (A.pattern_version() == pattern_version_ && first_node == first_node_) return;
  const auto slot = [&](int i, int j) { return slot_of(A, first_node + i, first_node + j); };
  slots_.resize(chunks_.row_edges.size());
  chunk_diagonal_.resize(chunks_.nodes.size());
  diagonal_.resize(static_cast<std::size_t>(chunks_.node_count()));
  for (std::size_t i = 0; i < diagonal_.size(); ++i)
    diagonal_[i] = slot(static_cast<int>(i), static_cast<int>(i));
  for (std::size_t n = 0; n < chunks_.nodes.size(); ++n)
    chunk_diagonal_[n] = diagonal_[static_cast<std::size_t>(chunks_.nodes[n])];
  for (const Chunk& chunk : chunks_.chunks)
    for (int n = chunk.first_node; n < chunk.first_node + chunk.nodes; ++n)
      for (int p = chunks_.row_start[static_cast<std::size_t>(n)];
           p < chunks_.row_start[static_cast<std::size_t>(n) + 1]; ++p) {
        const std::uint32_t entry = chunks_.row_edges[static_cast<std::size_t>(p)];
        const std::size_t other =
            2 * (static_cast<std::size_t>(chunk.first_edge) + entry / 2) + (1 - entry % 2);
        slots_[static_cast<std::size_t>(p)] =
            slot(chunks_.nodes[static_cast<std::size_t>(n)],
                 chunks_.nodes[static_cast<std::size_t>(chunk.first_node + chunks_.ends[other])]);
      }
  find_both_sides(chunks_.late_edges, slot, late_slots_);
  find_bare_slots(first_node, A);
  prefer_huge_pages(slots_);
  pattern_version_ = A.pattern_version();
  first_node_ = first_node;
}

void ElementEvaluation::find_bare_slots(int first_node, const dynamics::BlockSparse& A) {
  const auto row = [&](int node) { return A.row_start()[static_cast<std::size_t>(first_node + node)]; };
  const int first = row(0), end = row(chunks_.node_count());
  std::vector<char> filled(static_cast<std::size_t>(end - first), 0);
  for (const auto* slots : {&slots_, &chunk_diagonal_})
    for (std::int32_t slot : *slots) filled[static_cast<std::size_t>(slot - first)] = 1;
  bare_slots_.clear();
  for (int slot = first; slot < end; ++slot)
    if (!filled[static_cast<std::size_t>(slot - first)]) bare_slots_.push_back(slot);
}

/// Ascending in the matrix, so that its memory is written in order.
void ElementEvaluation::prepare_places(int first_node, const dynamics::BalancedMatrix& A) {
  if (A.places_version == places_version_ && first_node == places_first_node_) return;
  const auto place = [&](int i, int j) {
    return A.place[static_cast<std::size_t>(slot_of(*A.pattern, first_node + i, first_node + j))];
  };
  const auto place_of = [&](const Chunk& chunk, int edge) {
    const std::uint16_t* ends = chunks_.ends.data() + 2 * static_cast<std::size_t>(chunk.first_edge + edge);
    return place(chunks_.nodes[static_cast<std::size_t>(chunk.first_node + ends[0])],
                 chunks_.nodes[static_cast<std::size_t>(chunk.first_node + ends[1])]);
  };
  places_.assign(chunks_.ends.size() / 2, -1);
  leaving_edges_.assign(places_.size(), 0);
  std::vector<std::pair<std::int32_t, std::uint16_t>> own;
  for (const Chunk& chunk : chunks_.chunks) {
    own.clear();
    for (int k = 0; k < chunk.own_edges; ++k) own.emplace_back(place_of(chunk, k), k);
    std::sort(own.begin(), own.end());
    for (std::size_t k = 0; k < own.size(); ++k) {
      places_[static_cast<std::size_t>(chunk.first_edge) + k] = own[k].first;
      leaving_edges_[static_cast<std::size_t>(chunk.first_edge) + k] = own[k].second;
    }
    for (int k = chunk.own_edges; k < chunk.edges; ++k) {
      places_[static_cast<std::size_t>(chunk.first_edge + k)] = place_of(chunk, k);
      leaving_edges_[static_cast<std::size_t>(chunk.first_edge + k)] = static_cast<std::uint16_t>(k);
    }
  }
  late_places_.clear();
  for (int k = 0; k < chunks_.late_edges.count(); ++k)
    late_places_.push_back({place(chunks_.late_edges.first[static_cast<std::size_t>(k)],
                                  chunks_.late_edges.second[static_cast<std::size_t>(k)]),
                            k});
  std::sort(late_places_.begin(), late_places_.end(),
            [](const LatePlace& a, const LatePlace& b) { return a.place < b.place; });
  prefer_huge_pages(places_);
  places_version_ = A.places_version;
  places_first_node_ = first_node;
}

std::size_t ElementEvaluation::map_bytes() const {
  return bytes_of(slots_) + bytes_of(bare_slots_) + bytes_of(chunk_diagonal_) + bytes_of(late_slots_) +
         bytes_of(diagonal_) + bytes_of(places_) + bytes_of(leaving_edges_) + bytes_of(late_places_);
}

std::size_t ElementEvaluation::scratch_bytes() const {
  std::size_t sum = bytes_of(late_nodes_) + bytes_of(late_upper_) + bytes_of(late_lower_) +
                    bytes_of(late_diagonal_) + bytes_of(late_single_) + bytes_of(chunk_sums_);
  for (const Scratch& s : scratch_) {
    for (const auto* lines : {&s.x, &s.v, &s.w, &s.sum}) sum += bytes_of(*lines);
    for (const auto* blocks : {&s.upper, &s.lower, &s.diagonal, &s.leaving[0], &s.leaving[1]})
      sum += blocks->bytes();
  }
  return sum;
}

}  // namespace palpate::fem
