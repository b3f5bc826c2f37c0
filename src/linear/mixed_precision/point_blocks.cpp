#include "linear/mixed_precision/point_blocks.h"

#include <algorithm>
#include <utility>

namespace palpate::linear {
namespace {

std::size_t mixed(std::size_t h) {
  h *= 0x9e3779b97f4a7c15u;
  return h ^ (h >> 29);
}

bool same(const dynamics::PointStiffness::Nodes& a, const dynamics::PointStiffness::Nodes& b) {
  return a.count == b.count && a.relative == b.relative &&
         std::equal(a.node.begin(), a.node.begin() + a.count, b.node.begin());
}

/// Returns the size of a hash table with open addressing for `count` entries, a power of two.
std::size_t table_size(std::size_t count) {
  std::size_t size = 16;
  while (size < 2 * count) size *= 2;
  return size;
}

}  // namespace

PointBlocks::Set& PointBlocks::set_of(const Nodes& nodes) {
  if (last_ < set_count_ && same(sets_[last_].nodes, nodes)) return sets_[last_];
  std::size_t h = static_cast<std::size_t>(2 * nodes.count + nodes.relative);
  for (int i = 0; i < nodes.count; ++i)
    h = mixed(h + static_cast<std::size_t>(nodes.node[static_cast<std::size_t>(i)]));
  const std::size_t mask = table_.size() - 1;
  std::size_t at = h & mask;
  for (; table_[at] >= 0; at = (at + 1) & mask)
    if (same(sets_[static_cast<std::size_t>(table_[at])].nodes, nodes))
      return sets_[last_ = static_cast<std::size_t>(table_[at])];
  table_[at] = static_cast<int>(set_count_);
  if (set_count_ == sets_.size()) sets_.emplace_back();
  Set& out = sets_[last_ = set_count_++];
  out.nodes = nodes;
  out.C.fill(Six::Zero());
  return out;
}

void PointBlocks::find_rows(const std::vector<int>& place_of_node) {
  for (const int place : places_) row_[static_cast<std::size_t>(place)] = -1;
  places_.clear();
  row_.resize(place_of_node.size(), -1);
  for (std::size_t s = 0; s < set_count_; ++s) {
    Nodes& nodes = sets_[s].nodes;
    for (int i = 0; i < nodes.count; ++i) {
      int& node = nodes.node[static_cast<std::size_t>(i)];
      node = place_of_node[static_cast<std::size_t>(node)];
      if (std::exchange(row_[static_cast<std::size_t>(node)], 0) < 0) places_.push_back(node);
    }
  }
  std::sort(places_.begin(), places_.end());
  for (std::size_t r = 0; r < places_.size(); ++r)
    row_[static_cast<std::size_t>(places_[r])] = static_cast<int>(r);
}

PointBlocks::Six& PointBlocks::pair(int i, int j) {
  if (i > j) std::swap(i, j);
  const std::size_t mask = pair_table_.size() - 1;
  std::size_t at = mixed(static_cast<std::size_t>(i) * places_.size() + static_cast<std::size_t>(j)) & mask;
  for (; pair_table_[at] >= 0; at = (at + 1) & mask)
    if (Pair& found = pairs_[static_cast<std::size_t>(pair_table_[at])]; found.i == i && found.j == j)
      return found.C;
  pair_table_[at] = static_cast<int>(pairs_.size());
  pairs_.push_back({i, j, Six::Zero()});
  return pairs_.back().C;
}

void PointBlocks::sum(const dynamics::PointStiffness& points, const std::vector<int>& place_of_node) {
  set_count_ = 0;
  table_.assign(table_size(points.points.size()), -1);
  for (const auto& one : points.points) {
    Set& set = set_of(one.nodes);
    const Six C = of(one.C);
    for (int i = 0; i < one.nodes.count; ++i) {
      const Six row = one.weight[i] * C;
      for (int j = i; j < one.nodes.count; ++j)
        set.C[static_cast<std::size_t>(kMost * i + j)] += one.weight[j] * row;
    }
  }
  find_rows(place_of_node);
  std::size_t most = 0;
  for (std::size_t s = 0; s < set_count_; ++s)
    most += static_cast<std::size_t>(sets_[s].nodes.count * (sets_[s].nodes.count - 1) / 2);
  pair_table_.assign(table_size(most), -1);
  pairs_.clear();
  row_sums_.assign(places_.size(), Six::Zero());
  for (std::size_t s = 0; s < set_count_; ++s) {
    Set& set = sets_[s];
    const Nodes& nodes = set.nodes;
    for (int i = 0; i < nodes.count; ++i) {
      const int row = row_[static_cast<std::size_t>(nodes.node[static_cast<std::size_t>(i)])];
      for (int j = i; j < nodes.count; ++j) {
        const Six& C = set.C[static_cast<std::size_t>(kMost * i + j)];
        const int column = row_[static_cast<std::size_t>(nodes.node[static_cast<std::size_t>(j)])];
        if (column != row) pair(row, column) += C;
        if (nodes.relative) continue;
        row_sums_[static_cast<std::size_t>(row)] += C;
        if (j > i) row_sums_[static_cast<std::size_t>(column)] += C;
      }
    }
  }
}

}  // namespace palpate::linear
