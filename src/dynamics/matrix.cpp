#include "palpate/dynamics/matrix.h"

#include <algorithm>
#include <atomic>
#include <iterator>

#include "core/huge_pages.h"
#include "palpate/core/error.h"

namespace palpate::dynamics {
namespace {
std::uint64_t fresh_version() {
  static std::atomic<std::uint64_t> next{1};
  return next++;
}
using Block3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
}  // namespace

int BlockSparse::slot(int i, int j) const {
  const auto first = columns_.begin() + row_start_[static_cast<std::size_t>(i)];
  const auto last = columns_.begin() + row_start_[static_cast<std::size_t>(i) + 1];
  const auto it = std::lower_bound(first, last, j);
  return it != last && *it == j ? static_cast<int>(it - columns_.begin()) : -1;
}

void BlockSparse::set_zero(int first_row, int rows) {
  std::fill(block(row_start_[static_cast<std::size_t>(first_row)]),
            block(row_start_[static_cast<std::size_t>(first_row + rows)]), 0.0);
}

void BlockSparse::multiply_add(const double* x, double* y) const {
  for (int i = 0; i < block_rows(); ++i) {
    Vec3 sum = Vec3::Zero();
    for (int s = row_start_[static_cast<std::size_t>(i)]; s < row_start_[static_cast<std::size_t>(i) + 1];
         ++s)
      sum += Eigen::Map<const Block3>(block(s)) *
             Eigen::Map<const Vec3>(x + 3 * columns_[static_cast<std::size_t>(s)]);
    Eigen::Map<Vec3>(y + 3 * i) += sum;
  }
}

void BlockSparse::multiply_transposed_add(const double* x, double* y) const {
  for (int i = 0; i < block_rows(); ++i)
    for (int s = row_start_[static_cast<std::size_t>(i)]; s < row_start_[static_cast<std::size_t>(i) + 1];
         ++s)
      Eigen::Map<Vec3>(y + 3 * columns_[static_cast<std::size_t>(s)]) +=
          Eigen::Map<const Block3>(block(s)).transpose() * Eigen::Map<const Vec3>(x + 3 * i);
}

int PatternBuilder::first_node(int block_id) const {
  if (!layout_) return 0;
  const Block* block = layout_->find(block_id);
  PALPATE_CHECK(block && block->kind == BlockKind::kNodes, "block {} is not a node block of this layout",
                block_id);
  return block->u_offset / 3;
}

void PatternBuilder::add_pair(int i, int j) {
  PALPATE_CHECK(i >= 0 && j >= 0 && i < node_count_ && j < node_count_,
                "pair ({}, {}) is out of range: there are {} nodes", i, j, node_count_);
  pairs_.emplace_back(i, j);
  pairs_.emplace_back(j, i);
}

void PatternBuilder::add_clique(const int* nodes, int count) {
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < count; ++b) add_pair(nodes[a], nodes[b]);
}

NodePairs PatternBuilder::pairs() const {
  NodePairs sorted = pairs_;
  sort_unique(sorted, node_count_);
  return sorted;
}

// Counting sort by the first node, then a comparison sort of the few second nodes of each.
void sort_unique(NodePairs& pairs, int node_count) {
  std::vector<std::size_t> start(static_cast<std::size_t>(node_count) + 2, 0);
  for (const auto& pair : pairs) ++start[static_cast<std::size_t>(pair.first) + 2];
  for (std::size_t i = 2; i < start.size(); ++i) start[i] += start[i - 1];
  std::vector<int> second(pairs.size());
  for (const auto& [i, j] : pairs) second[start[static_cast<std::size_t>(i) + 1]++] = j;
  std::size_t kept = 0;
  for (int i = 0; i < node_count; ++i) {
    const auto first = second.begin() + static_cast<std::ptrdiff_t>(start[static_cast<std::size_t>(i)]),
               last = second.begin() + static_cast<std::ptrdiff_t>(start[static_cast<std::size_t>(i) + 1]);
    std::sort(first, last);
    const auto end = std::unique(first, last);
    for (auto j = first; j != end; ++j) pairs[kept++] = {i, *j};
  }
  pairs.resize(kept);
}

BlockSparse PatternBuilder::build() const {
  const NodePairs all = pairs();
  return pattern_of(node_count_, {&all});
}

BlockSparse pattern_of(int node_count, const std::vector<const NodePairs*>& lists) {
  NodePairs all, more;
  for (int i = 0; i < node_count; ++i) all.emplace_back(i, i);
  for (const NodePairs* list : lists) {
    if (list->empty()) continue;
    more.clear();
    more.reserve(all.size() + list->size());
    std::set_union(all.begin(), all.end(), list->begin(), list->end(), std::back_inserter(more));
    all.swap(more);
  }
  BlockSparse out;
  out.row_start_.assign(static_cast<std::size_t>(node_count) + 1, 0);
  out.columns_.reserve(all.size());
  out.diagonal_.resize(static_cast<std::size_t>(node_count));
  for (const auto& [i, j] : all) {
    ++out.row_start_[static_cast<std::size_t>(i) + 1];
    if (i == j) out.diagonal_[static_cast<std::size_t>(i)] = static_cast<int>(out.columns_.size());
    out.columns_.push_back(j);
  }
  for (std::size_t i = 1; i < out.row_start_.size(); ++i) out.row_start_[i] += out.row_start_[i - 1];
  out.values_.assign(9 * all.size(), 0.0);
  prefer_huge_pages(out.values_);
  out.pattern_version_ = fresh_version();
  return out;
}

void BorderedMatrix::set_zero() {
  body.set_zero();
  right.setZero();
  bottom.setZero();
  corner.setZero();
}

void BorderedMatrix::touch() { values_version = fresh_version(); }

void BorderedMatrix::multiply(const VecX& x, VecX& y) const {
  const Eigen::Index n = nodal_size(), m = border_size();
  PALPATE_CHECK(x.size() == n + m, "x has {} entries, the matrix {}", x.size(), n + m);
  y.setZero(n + m);
  body.multiply_add(x.data(), y.data());
  if (m == 0) return;
  y.head(n).noalias() += right * x.tail(m);
  y.tail(m).noalias() += bottom * x.head(n);
  y.tail(m).noalias() += corner * x.tail(m);
}

MatX BorderedMatrix::to_dense() const {
  const Eigen::Index n = nodal_size(), m = border_size();
  MatX dense = MatX::Zero(n + m, n + m);
  for (int i = 0; i < body.block_rows(); ++i)
    for (int s = body.row_start()[static_cast<std::size_t>(i)];
         s < body.row_start()[static_cast<std::size_t>(i) + 1]; ++s)
      dense.block<3, 3>(3 * i, 3 * body.columns()[static_cast<std::size_t>(s)]) =
          Eigen::Map<const Block3>(body.block(s));
  if (m > 0) {
    dense.topRightCorner(n, m) = right;
    dense.bottomLeftCorner(m, n) = bottom;
    dense.bottomRightCorner(m, m) = corner;
  }
  return dense;
}

}  // namespace palpate::dynamics
