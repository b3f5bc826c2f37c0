#include "integrate/linear/single_matrix.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "palpate/core/error.h"
#include "palpate/core/huge_pages.h"

namespace palpate::integrate {

using dynamics::SolveStatus;

namespace {

/// Rows of one length after each other: the end of a row is then foreseen, where a wrong guess costs as much as some blocks.
void sort_rows(const dynamics::BlockSparse& pattern, NodeOrder& order) {
  const auto length = [&](int i) { return pattern.row_start()[static_cast<std::size_t>(i) + 1] - pattern.row_start()[static_cast<std::size_t>(i)]; };
  for (int c = 0; c < order.clusters(); ++c)
    std::stable_sort(order.node.begin() + order.start[static_cast<std::size_t>(c)], order.node.begin() + order.start[static_cast<std::size_t>(c) + 1],
                     [&](int a, int b) { return length(a) < length(b); });
}

}  // namespace

void SingleMatrix::analyse(const dynamics::BlockSparse& pattern, int clusters) {
  pattern_version_ = pattern.pattern_version();
  order_ = cluster_nodes(pattern, clusters);
  sort_rows(pattern, order_);
  const std::size_t n = order_.node.size();
  place_of_node_.resize(n);
  for (std::size_t k = 0; k < n; ++k) place_of_node_[static_cast<std::size_t>(order_.node[k])] = static_cast<int>(k);
  row_start_.assign(1, 0);
  column_.clear();
  source_.clear();
  diagonal_slot_.resize(n);
  std::vector<std::pair<int, int>> row;
  for (std::size_t k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(order_.node[k]);
    row.clear();
    for (int s = pattern.row_start()[i]; s < pattern.row_start()[i + 1]; ++s)
      row.emplace_back(place_of_node_[static_cast<std::size_t>(pattern.columns()[static_cast<std::size_t>(s)])], s);
    std::sort(row.begin(), row.end());
    const auto own = std::find_if(row.begin(), row.end(), [&](const auto& block) { return block.first == static_cast<int>(k); });
    diagonal_slot_[k] = own->second;
    std::rotate(row.begin(), own, own + 1);
    for (const auto& [column, slot] : row) {
      column_.push_back(column);
      source_.push_back(slot);
    }
    row_start_.push_back(static_cast<int>(column_.size()));
  }
  written_ = {};
  written_.values.assign(9 * column_.size() + kBlockTail, 0.0f);
  prefer_huge_pages(written_.values);
  prefer_huge_pages(column_);
  prefer_huge_pages(source_);
  inverse_.assign(kInverseStride * n + kVectorTail, 0.0f);
  good_.assign(static_cast<std::size_t>(order_.clusters()), 0);
  own_.clear();
  team_.share(order_, row_start_);
}

SolveStatus SingleMatrix::take(const dynamics::BorderedMatrix& A, int count, const Doubles* from, Doubles* to) {
  original_ = &A;
  const double* values = A.body.values().data();
  // A power of two near 1/(mean of the diagonal): single precision overflows where double does not.
  double mean = 0.0;
  for (const int slot : diagonal_slot_) mean += values[9 * static_cast<std::size_t>(slot)] / nodes();
  if (!std::isfinite(mean)) return SolveStatus::kSingular;
  if (!(mean > 0.0)) return SolveStatus::kIndefinite;
  written_.scale = std::ldexp(1.0, -std::ilogb(mean));
  if (!good_of(count, from, to, written_.values.data(), false)) return SolveStatus::kSingular;
  return invert(values, diagonal_slot_.data(), written_.scale) ? SolveStatus::kOk : SolveStatus::kIndefinite;
}

dynamics::BalancedMatrix& SingleMatrix::room(const dynamics::BlockSparse& pattern) {
  static std::atomic<std::uint64_t> version{0};
  written_.pattern = &pattern;
  if (!own_.empty()) return written_;
  own_.assign(9 * order_.node.size() + 3, 0.0);
  mass_.assign(4 * order_.node.size(), 0.0);
  written_.place.resize(column_.size());
  for (std::size_t s = 0; s < column_.size(); ++s) written_.place[static_cast<std::size_t>(source_[s])] = static_cast<int>(s);
  written_.places_version = ++version;
  mirror_.resize(column_.size());
  for (int i = 0; i < nodes(); ++i)
    for (int s = row_start_[static_cast<std::size_t>(i)]; s < row_start_[static_cast<std::size_t>(i) + 1]; ++s) {
      const auto j = static_cast<std::size_t>(column_[static_cast<std::size_t>(s)]);
      const auto first = column_.begin() + row_start_[j];
      const auto found = *first == i ? first : std::lower_bound(first + 1, column_.begin() + row_start_[j + 1], i);
      mirror_[static_cast<std::size_t>(s)] = static_cast<int>(found - column_.begin());
    }
  return written_;
}

SolveStatus SingleMatrix::take_balanced(int count, const Doubles* from, Doubles* to) {
  original_ = nullptr;
  const std::size_t n = order_.node.size();
  PALPATE_CHECK(written_.diagonal.size() == static_cast<Eigen::Index>(3 * n), "a balanced matrix of {} nodes with {} masses", n, written_.diagonal.size());
  double mass = 0.0, own = 0.0;
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      mass += mass_[4 * k + axis] = written_.scale * written_.diagonal[static_cast<Eigen::Index>(3 * static_cast<std::size_t>(order_.node[k]) + axis)];
  if (!good_of(count, from, to, nullptr, true)) return SolveStatus::kSingular;
  for (std::size_t k = 0; k < n; ++k) own += own_[9 * k] + own_[9 * k + 4] + own_[9 * k + 8];
  stiffness_ = own / mass;
  hold(count, from, to);
  return invert(own_.data(), nullptr, 1.0) ? SolveStatus::kOk : SolveStatus::kIndefinite;
}

BalancedBlocks SingleMatrix::balanced_blocks() {
  return {row_start_.data(), column_.data(), written_.values.data(), mass_.data(), own_.data(), 1.0 / written_.scale};
}

/// Products; and the copy of the original, or the diagonal of a balanced matrix.  False where a number is not finite.
bool SingleMatrix::good_of(int count, const Doubles* from, Doubles* to, float* copy, bool balance) {
  const double* V[kMostColumns] = {};
  double* AV[kMostColumns] = {};
  for (int k = 0; k < count; ++k) {
    V[k] = from[k].data();
    AV[k] = to[k].data();
  }
  if (original_) {
    const DoubleBlocks A{row_start_.data(), column_.data(), source_.data(), original_->body.values().data(), block_count() - 1};
    team_.for_each([&](std::size_t c, int first, int last) { good_[c] = kernels_.convert(A, written_.scale, copy, count, V, AV, first, last); });
  } else if (balance) {
    team_.for_each([&](std::size_t c, int first, int last) { good_[c] = kernels_.balance(balanced_blocks(), count, V, AV, first, last); });
  } else {
    team_.for_each([&](std::size_t, int first, int last) { kernels_.multiply_balanced(balanced_blocks(), count, V, AV, first, last); });
    return true;
  }
  return std::find(good_.begin(), good_.end(), char{0}) == good_.end();
}

bool SingleMatrix::invert(const double* values, const int* slot, double scale) {
  team_.for_each([&](std::size_t c, int first, int last) { good_[c] = kernels_.invert_diagonal(values, slot, scale, inverse_.data(), first, last); });
  return std::find(good_.begin(), good_.end(), char{0}) == good_.end();
}

/// Rows and columns of held directions become the identity's.  What they carried is in the diagonal blocks of their neighbours already, as it must be; the products
/// are those of vectors that are zero along held directions.
void SingleMatrix::hold(int count, const Doubles* from, Doubles* to) {
  if (!written_.held) return;
  for (const dynamics::HeldNode& held : *written_.held) {
    const auto node = static_cast<std::size_t>(place_of_node_[static_cast<std::size_t>(held.node)]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!held.axes[axis]) continue;
      for (int s = row_start_[node]; s < row_start_[node + 1]; ++s) {
        float *block = written_.values.data() + 9 * static_cast<std::size_t>(s), *mirrored = written_.values.data() + 9 * static_cast<std::size_t>(mirror_[static_cast<std::size_t>(s)]);
        for (std::size_t c = 0; c < 3; ++c) block[3 * c + axis] = mirrored[3 * axis + c] = 0.0f;
      }
      double* own = own_.data() + 9 * node;
      for (std::size_t c = 0; c < 3; ++c) own[3 * c + axis] = own[3 * axis + c] = 0.0;
      own[4 * axis] = written_.scale;
      written_.values[9 * static_cast<std::size_t>(row_start_[node]) + 4 * axis] = static_cast<float>(written_.scale);
      for (int k = 0; k < count; ++k) to[k][4 * node + axis] = from[k][4 * node + axis];
    }
  }
}

}  // namespace palpate::integrate
