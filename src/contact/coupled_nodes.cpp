#include "contact/coupled_nodes.h"

#include <algorithm>
#include <iterator>

namespace palpate::contact {
namespace {

int node_count(const dynamics::NodePairs& pairs) {
  int last = -1;
  for (const auto& [i, j] : pairs) last = std::max(last, i);
  return last + 1;
}

bool same_nodes(const ContactSample& s, const ContactSample& t) {
  return s.a.count == t.a.count && s.b.count == t.b.count && s.a.node == t.a.node && s.b.node == t.b.node;
}

std::size_t hash_of(const ContactSample& s) {
  std::size_t h = 0;
  for (const SurfacePoint* p : {&s.a, &s.b})
    for (const int node : p->node) h = h * 1000003u + static_cast<std::size_t>(node);
  return h ^ (h >> 19);
}

}  // namespace

NodeNeighbours::NodeNeighbours(const Eigen::Ref<const Eigen::MatrixXi>& cells, int first) : first_(first) {
  std::vector<std::pair<int, int>> pairs;
  pairs.reserve(static_cast<std::size_t>(cells.size() * cells.rows()));
  for (Eigen::Index cell = 0; cell < cells.cols(); ++cell)
    for (Eigen::Index i = 0; i < cells.rows(); ++i)
      for (Eigen::Index j = 0; j < cells.rows(); ++j) pairs.emplace_back(cells(i, cell), cells(j, cell));
  dynamics::sort_unique(pairs, cells.size() > 0 ? cells.maxCoeff() + 1 : 0);
  start_.assign(pairs.empty() ? 1 : static_cast<std::size_t>(pairs.back().first) + 2, 0);
  nodes_.reserve(pairs.size());
  for (const auto& [i, j] : pairs) {
    ++start_[static_cast<std::size_t>(i) + 1];
    nodes_.push_back(first + j);
  }
  for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
}

std::span<const int> NodeNeighbours::of(int node) const {
  const auto at = static_cast<std::size_t>(node - first_);
  return std::span(nodes_).subspan(static_cast<std::size_t>(start_[at]),
                                   static_cast<std::size_t>(start_[at + 1] - start_[at]));
}

/// Pairs of nodes of the samples; thousands of samples have the same nodes.
void CoupledNodes::find_met(std::span<const ContactSample> samples) {
  met_.clear();
  std::size_t size = 16;
  while (size < 2 * samples.size()) size *= 2;
  table_.assign(size, -1);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const ContactSample& s = samples[k];
    if (k > 0 && same_nodes(samples[k - 1], s)) continue;  // neighbours in a row of pixels
    std::size_t at = hash_of(s) & (size - 1);
    while (table_[at] >= 0 && !same_nodes(samples[static_cast<std::size_t>(table_[at])], s))
      at = (at + 1) & (size - 1);
    if (table_[at] >= 0) continue;
    table_[at] = static_cast<int>(k);
    for (int i = 0; i < s.a.count; ++i)
      for (int j = 0; j < s.b.count; ++j)
        met_.emplace_back(s.a.node[static_cast<std::size_t>(i)], s.b.node[static_cast<std::size_t>(j)]);
  }
  dynamics::sort_unique(met_, node_count(met_));
}

void CoupledNodes::widen(const NodeNeighbours& a, const NodeNeighbours& b) {
  both_.clear();
  for (const auto& [i, j] : met_)
    for (const int near : a.of(i)) both_.emplace_back(near, j);
  dynamics::sort_unique(both_, node_count(both_));
  wide_.clear();
  for (const auto& [i, j] : both_)
    for (const int near : b.of(j)) wide_.emplace_back(i, near);
  dynamics::sort_unique(wide_, node_count(wide_));
}

void CoupledNodes::take(std::span<const ContactSample> samples, const NodeNeighbours& a,
                        const NodeNeighbours& b) {
  constexpr std::size_t kLargest = 2;
  find_met(samples);
  if (std::includes(pairs_.begin(), pairs_.end(), met_.begin(), met_.end())) return;
  widen(a, b);
  both_.clear();
  std::set_union(pairs_.begin(), pairs_.end(), wide_.begin(), wide_.end(), std::back_inserter(both_));
  pairs_ = both_.size() > kLargest * wide_.size() ? wide_ : both_;
  ++version_;
}

void CoupledNodes::forget() {
  if (pairs_.empty()) return;
  pairs_.clear();
  ++version_;
}

void CoupledNodes::add_pattern(dynamics::PatternBuilder& pattern) const {
  for (const auto& [i, j] : pairs_) pattern.add_pair(i, j);
}

}  // namespace palpate::contact
