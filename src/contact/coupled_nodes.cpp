#include "contact/coupled_nodes.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace palpate::contact {
namespace {

int node_count(const dynamics::NodePairs& pairs) {
  int last = -1;
  for (const auto& [i, j] : pairs) last = std::max(last, i);
  return last + 1;
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

/// Calls visit(i, j) for the nodes that two carriers couple, until it returns false.
template <class Visit>
bool CoupledNodes::for_each_pair(const Joint& joint, Visit visit) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(joint.count_a); ++i)
    for (std::size_t j = 0; j < static_cast<std::size_t>(joint.count_b); ++j)
      if (!visit(joint.a[i], joint.b[j])) return false;
  return true;
}

/// Returns whether the pattern contains all pairs that the joints couple. Most joints are known from earlier
/// queries by their carriers.
bool CoupledNodes::holds() {
  for (const Joint& joint : joints_) {
    if (known_.contains(joint.key)) continue;
    const bool there = for_each_pair(joint, [&](int i, int j) {
      return std::binary_search(pairs_.begin(), pairs_.end(), std::pair(i, j));
    });
    if (!there) return false;
    known_.insert(joint.key);
  }
  return true;
}

void CoupledNodes::widen() {
  both_.clear();
  for (const auto& [i, j] : met_)
    for (const int near : of_a_->of(i)) both_.emplace_back(near, j);
  dynamics::sort_unique(both_, node_count(both_));
  wide_.clear();
  for (const auto& [i, j] : both_)
    for (const int near : of_b_->of(j)) wide_.emplace_back(i, near);
  dynamics::sort_unique(wide_, node_count(wide_));
}

void CoupledNodes::take(std::span<const Joint> joints) {
  joints_.assign(joints.begin(), joints.end());
  behind_ = true;
}

void CoupledNodes::catch_up() {
  constexpr std::size_t kLargest = 2;
  if (!std::exchange(behind_, false) || holds()) return;
  met_.clear();
  for (const Joint& joint : joints_)
    for_each_pair(joint, [&](int i, int j) {
      met_.emplace_back(i, j);
      return true;
    });
  dynamics::sort_unique(met_, node_count(met_));
  widen();
  both_.clear();
  std::set_union(pairs_.begin(), pairs_.end(), wide_.begin(), wide_.end(), std::back_inserter(both_));
  pairs_ = both_.size() > kLargest * wide_.size() ? wide_ : both_;
  known_.clear();
  ++version_;
}

void CoupledNodes::start(const NodeNeighbours& a, const NodeNeighbours& b) {
  of_a_ = &a;
  of_b_ = &b;
  joints_.clear();
  behind_ = false;
  if (pairs_.empty()) return;
  pairs_.clear();
  known_.clear();
  ++version_;
}

void CoupledNodes::add_pattern(dynamics::PatternBuilder& pattern) {
  catch_up();
  for (const auto& [i, j] : pairs_) pattern.add_pair(i, j);
}

std::uint64_t CoupledNodes::version() {
  catch_up();
  return version_;
}

}  // namespace palpate::contact
