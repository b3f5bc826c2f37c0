#include "linear/mixed_precision/single_matrix.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/LU>

#include "core/huge_pages.h"
#include "palpate/core/error.h"

namespace palpate::linear {

using dynamics::SolveStatus;

namespace {

/// Pointers to the columns of a product.
struct BorderColumns {
  const float* V[kMostColumns] = {};
  float* AV[kMostColumns] = {};
  BorderColumns(int count, const Singles* from, Singles* to) {
    for (int k = 0; k < count; ++k) {
      V[k] = from[k].data();
      AV[k] = to[k].data();
    }
  }
};

/// Returns the FNV-1a hash, word by word, of the place of each pair's block; never zero.
std::uint64_t key_of(const dynamics::BlockSparse& pattern, const std::vector<int>& slot_map) {
  std::uint64_t key = 0xcbf29ce484222325u;
  const auto add = [&](int word) { key = (key ^ static_cast<std::uint32_t>(word)) * 0x100000001b3u; };
  for (const int row : pattern.row_start()) add(row);
  for (const int column : pattern.columns()) add(column);
  for (const int slot : slot_map) add(slot);
  return key | 1u;
}

}  // namespace

void SingleMatrix::analyse(const dynamics::BlockSparse& pattern, const NodeOrderSizes& sizes) {
  pattern_version_ = pattern.pattern_version();
  order_ = cluster_nodes(pattern, sizes.clusters, sizes.parts, sizes.pieces);
  const std::size_t n = order_.node.size();
  place_of_node_.resize(n);
  for (std::size_t k = 0; k < n; ++k)
    place_of_node_[static_cast<std::size_t>(order_.node[k])] = static_cast<int>(k);
  row_start_.assign(1, 0);
  column_.clear();
  source_.clear();
  points_.clear();
  diagonal_slot_.resize(n);
  std::vector<std::pair<int, int>> row;
  for (std::size_t k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(order_.node[k]);
    row.clear();
    for (int s = pattern.row_start()[i]; s < pattern.row_start()[i + 1]; ++s)
      row.emplace_back(
          place_of_node_[static_cast<std::size_t>(pattern.columns()[static_cast<std::size_t>(s)])], s);
    std::sort(row.begin(), row.end());
    const auto own = std::find_if(row.begin(), row.end(),
                                  [&](const auto& block) { return block.first == static_cast<int>(k); });
    diagonal_slot_[k] = own->second;
    std::rotate(row.begin(), own, own + 1);
    for (const auto& [column, slot] : row) {
      column_.push_back(column);
      source_.push_back(slot);
    }
    row_start_.push_back(static_cast<int>(column_.size()));
  }
  packing_.analyse(order_, row_start_, column_);
  written_ = {};
  for (auto* v : {&copy_, &mass_single_}) v->clear();
  prefer_huge_pages(source_);
  inverse_.assign(static_cast<std::size_t>(inverse_place(static_cast<int>(n) + 3)) + kVectorTail, 0.0f);
  const auto parts = static_cast<std::size_t>(order_.parts());
  good_.assign(parts, 0);
  row_status_.assign(parts, RowStatus::kOk);
  trace_.assign(parts, 0.0);
  mass_trace_ = trace_;
  held_.clear();
  team_.share(order_);
}

SolveStatus SingleMatrix::take(const dynamics::BorderedMatrix& A, int count, Singles* from, Singles* to) {
  original_ = &A;
  held_.clear();
  points_.clear();
  if (copy_.empty()) {
    copy_.assign(9 * static_cast<std::size_t>(block_count() + 1) + kBlockTail, 0.0f);  // plus a zero block
    copy_offset_.assign(packing_.places() + kLanesOfGroup * kStepsAhead, 9 * block_count());
    for (std::size_t s = 0; s < column_.size(); ++s)
      if (!packing_.transposed(s)) copy_offset_[packing_.place(s)] = 9 * static_cast<int>(s);
    prefer_huge_pages(copy_);
    prefer_huge_pages(copy_offset_);
  }
  const double* values = A.body.values().data();
  // Scale: a power of two near 1/(mean of the diagonal), since single precision overflows where double does
  // not.
  double mean = 0.0;
  for (const int slot : diagonal_slot_) mean += values[9 * static_cast<std::size_t>(slot)] / nodes();
  if (!std::isfinite(mean)) return SolveStatus::kSingular;
  if (!(mean > 0.0)) return SolveStatus::kIndefinite;
  written_.scale = std::ldexp(1.0, -std::ilogb(mean));
  const DoubleBlocks whole{row_start_.data(), column_.data(), source_.data(), values, block_count() - 1};
  team_.for_each([&](std::size_t c, int first, int last) {
    good_[c] = kernels_.convert(whole, written_.scale, copy_.data(), first, last);
  });
  if (std::find(good_.begin(), good_.end(), char{0}) != good_.end()) return SolveStatus::kSingular;
  team_.for_each([&](std::size_t c, int first, int last) {
    kernels_.pack(rows(c), {copy_.data(), copy_offset_.data(), nullptr});
    good_[c] =
        kernels_.invert_diagonal(values, diagonal_slot_.data(), written_.scale, inverse_.data(), first, last);
    multiply(c, count, from, to);
  });
  return std::find(good_.begin(), good_.end(), char{0}) == good_.end() ? SolveStatus::kOk
                                                                       : SolveStatus::kIndefinite;
}

/// Each pair of nodes has one block there, part by part and row by row, with the rows in the order of their
/// nodes. Neighbouring elements then write to neighbouring memory, and packing reads the blocks of sixteen
/// rows as sixteen sequential streams.
dynamics::ZeroRowSumMatrix& SingleMatrix::room(const dynamics::BlockSparse& pattern) {
  written_.pattern = &pattern;
  if (!mass_single_.empty()) return written_;
  const std::size_t n = order_.node.size();
  mass_.assign(4 * n + kVectorTail, 0.0);
  mass_single_.assign(4 * n + kVectorTail, 0.0f);
  sums_.assign(8 * n + kVectorTail, 0.0f);
  const int pairs = (block_count() - nodes()) / 2;
  written_.values.assign(9 * static_cast<std::size_t>(pairs + 1) + kBlockTail, 0.0f);  // plus a zero block
  written_.slot_map.assign(column_.size(), -1);
  written_offset_.assign(packing_.places() + kLanesOfGroup * kStepsAhead, 9 * pairs);
  transposed_.assign(packing_.places() / kLanesOfGroup, 0);
  std::vector<int> rows(n);
  std::iota(rows.begin(), rows.end(), 0);
  for (std::size_t p = 0; p + 1 < order_.part.size(); ++p)
    std::sort(rows.begin() + order_.first_node(p), rows.begin() + order_.first_node(p + 1),
              [&](int a, int b) {
                return order_.node[static_cast<std::size_t>(a)] < order_.node[static_cast<std::size_t>(b)];
              });
  int next = 0;
  for (const int row : rows)
    for (auto s = static_cast<std::size_t>(row_start_[static_cast<std::size_t>(row)]) + 1;
         s < static_cast<std::size_t>(row_start_[static_cast<std::size_t>(row) + 1]); ++s) {
      if (packing_.transposed(s)) continue;
      const int i = order_.node[static_cast<std::size_t>(row)],
                j = order_.node[static_cast<std::size_t>(column_[s])];
      const std::size_t at = packing_.place(s), step = at / kLanesOfGroup;
      int& number = written_.slot_map[static_cast<std::size_t>(source_[s])];
      if (number < 0) written_.slot_map[static_cast<std::size_t>(pattern.slot(j, i))] = number = next++;
      written_offset_[at] = 9 * number;
      // blocks are written row-major and read column-major, that is, transposed
      if (i < j)
        transposed_[step] = static_cast<std::uint16_t>(transposed_[step] | (1u << at % kLanesOfGroup));
    }
  written_.slot_map_key = key_of(pattern, written_.slot_map);
  prefer_huge_pages(written_.values);
  prefer_huge_pages(written_offset_);
  return written_;
}

SolveStatus SingleMatrix::take_step_matrix(int count, Singles* from, Singles* to) {
  original_ = nullptr;
  const std::size_t n = order_.node.size();
  PALPATE_CHECK(written_.diagonal.size() == static_cast<Eigen::Index>(3 * n),
                "zero-row-sum matrix of {} nodes: {} masses, but 3 per node needed", n,
                written_.diagonal.size());
  find_held();
  const bool definite =
      points_.take(written_.points, written_.border, place_of_node_, order_, written_.scale);
  point_stiffness_ = 0.0;
  for (int k = 0; k < count; ++k)
    for (const std::size_t entry : held_) from[k][entry] = 0.0f;
  team_.for_each([&](std::size_t c, int first, int last) {
    double sum = 0.0;
    for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last); ++k) {
      const double* diagonal = written_.diagonal.data() + 3 * static_cast<std::size_t>(order_.node[k]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double m = written_.scale * diagonal[axis];
        sum += mass_[4 * k + axis] = m;
        mass_single_[4 * k + axis] = static_cast<float>(m);
      }
    }
    mass_trace_[c] = sum;
    const BorderColumns columns(count, from, to);
    row_status_[c] =
        kernels_.complete(rows(c), {written_.values.data(), written_offset_.data(), transposed_.data()},
                          sums_.data(), inverse_.data(), &trace_[c], count, columns.V, columns.AV);
    for (int k = 0; k < count; ++k) {
      if (!points_.empty()) points_.product(c, columns.V[k], columns.AV[k]);
      zero_held(c, columns.AV[k]);
    }
    hold(c);
  });
  add_points_to_inverse();
  const auto any = [&](RowStatus what) {
    return std::find(row_status_.begin(), row_status_.end(), what) != row_status_.end();
  };
  if (any(RowStatus::kNotFinite)) return SolveStatus::kSingular;
  stiffness_ = std::accumulate(trace_.begin(), trace_.end(), 0.0) /
               std::accumulate(mass_trace_.begin(), mass_trace_.end(), 0.0);
  return !definite || any(RowStatus::kNotDefinite) ? SolveStatus::kIndefinite : SolveStatus::kOk;
}

bool SingleMatrix::renew_points(int count, Singles* from, Singles* to) {
  add_point_products(-1.0f, count, from, to);
  for (const PointOperator::Diagonal& at : points_.diagonal()) {
    const auto node = static_cast<std::size_t>(at.node);
    store_inverse(node, own_block(node));
  }
  const bool definite =
      points_.take(written_.points, written_.border, place_of_node_, order_, written_.scale);
  point_stiffness_ = 0.0;
  add_points_to_inverse();
  add_point_products(1.0f, count, from, to);
  return definite;
}

/// Adds to[k] += sign times the points' part of scale A from[k].
void SingleMatrix::add_point_products(float sign, int count, Singles* from, Singles* to) {
  if (points_.empty() || count == 0) return;
  of_points_.resize(from[0].size(), 0.0f);
  for (int k = 0; k < count; ++k) {
    for (std::size_t part = 0; part < static_cast<std::size_t>(order_.parts()); ++part) {
      points_.product(part, from[k].data(), of_points_.data());
      zero_held(part, of_points_.data());
    }
    for (const PointOperator::Diagonal& row : points_.diagonal()) {
      const Eigen::Index at = 4 * static_cast<Eigen::Index>(row.node);
      Eigen::Map<Eigen::Vector4f> own(of_points_.data() + at);
      Eigen::Map<Eigen::Vector4f>(to[k].data() + at) += sign * own;
      own.setZero();
    }
  }
}

void SingleMatrix::multiply(std::size_t part, int count, const Singles* from, Singles* to) {
  const BorderColumns columns(count, from, to);
  kernels_.multiply(rows(part), count, columns.V, columns.AV);
  for (int k = 0; k < count; ++k) {
    if (!points_.empty()) points_.product(part, columns.V[k], columns.AV[k]);
    zero_held(part, columns.AV[k]);
  }
}

void SingleMatrix::multiply(int count, const Singles* from, Singles* to) {
  team_.for_each([&](std::size_t c, int, int) { multiply(c, count, from, to); });
}

void SingleMatrix::multiply(const Doubles& x, Doubles& Ax) {
  if (original_) {
    const DoubleBlocks A{row_start_.data(), column_.data(), source_.data(), original_->body.values().data(),
                         block_count() - 1};
    return team_.for_each([&](std::size_t, int first, int last) {
      kernels_.multiply_double(A, x.data(), Ax.data(), first, last);
    });
  }
  team_.for_each([&](std::size_t c, int, int) {
    kernels_.multiply_zero_row_sum(rows(c), mass_.data(), 1.0 / written_.scale, x.data(), Ax.data());
    if (!points_.empty()) points_.product(c, x.data(), Ax.data());
    zero_held(c, Ax.data());
  });
}

double SingleMatrix::product(std::size_t part, const float* p, float* q) const {
  double pq = kernels_.product(rows(part), p, q);
  if (!points_.empty()) pq += points_.product(part, p, q);
  zero_held(part, q);
  return pq;
}

// Held directions: rows and columns are those of the identity. Vectors are zero there and stay so, and
// products are set to zero. Dropping their columns is consistent: the diagonal blocks of the neighbours
// already contain them.

void SingleMatrix::find_held() {
  held_.clear();
  if (written_.held)
    for (const dynamics::HeldNode& held : *written_.held)
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (held.axes[axis])
          held_.push_back(4 * static_cast<std::size_t>(place_of_node_[static_cast<std::size_t>(held.node)]) +
                          axis);
  std::sort(held_.begin(), held_.end());
  held_start_.resize(order_.part.size());
  for (std::size_t p = 0; p < held_start_.size(); ++p)
    held_start_[p] = static_cast<std::size_t>(
        std::lower_bound(held_.begin(), held_.end(), 4 * static_cast<std::size_t>(order_.first_node(p))) -
        held_.begin());
}

template <class Real>
void SingleMatrix::zero_held(std::size_t part, Real* v) const {
  if (held_.empty()) return;
  for (std::size_t h = held_start_[part]; h < held_start_[part + 1]; ++h) v[held_[h]] = Real{0};
}

void SingleMatrix::take_held(std::size_t part, double* v, double* values) const {
  if (held_.empty()) return;
  for (std::size_t h = held_start_[part]; h < held_start_[part + 1]; ++h)
    values[h] = std::exchange(v[held_[h]], 0.0);
}

/// Sets the diagonal blocks of held nodes and their inverses.
void SingleMatrix::hold(std::size_t part) {
  for (std::size_t h = held_start_[part]; h < held_start_[part + 1];) {
    const std::size_t node = held_[h] / 4, own = static_cast<std::size_t>(row_start_[node]);
    for (; h < held_start_[part + 1] && held_[h] / 4 == node; ++h) {
      const int axis = static_cast<int>(held_[h] % 4);
      for (int k = 0; k < 3; ++k) packing_.own_entry(own, k, axis) = packing_.own_entry(own, axis, k) = 0.0f;
      packing_.own_entry(own, axis, axis) = 1.0f;
    }
    store_inverse(node, own_block(node));
  }
}

/// Returns the packed diagonal block, without the contribution of points.
Eigen::Matrix3f SingleMatrix::own_block(std::size_t node) const {
  Eigen::Matrix3f out;
  for (int k = 0; k < 9; ++k)
    out(k % 3, k / 3) = packing_.entry(static_cast<std::size_t>(row_start_[node]), k % 3, k / 3);
  return out;
}

void SingleMatrix::store_inverse(std::size_t node, const Eigen::Matrix3f& block) {
  const Eigen::Matrix3f inverse = block.inverse();
  float* J = inverse_.data() + inverse_place(static_cast<int>(node));
  for (int axis = 0; axis < 3; ++axis) {
    J[axis] = inverse(axis, axis);
    J[kToOffDiagonal + axis] = inverse((axis + 1) % 3, (axis + 2) % 3);
  }
}

/// Updates the inverse diagonal blocks of nodes in contact. The packed diagonal block excludes the contact's
/// share, which products add.
void SingleMatrix::add_points_to_inverse() {
  for (const PointOperator::Diagonal& at : points_.diagonal()) {
    const auto node = static_cast<std::size_t>(at.node);
    const Eigen::Matrix3f block = own_block(node);
    Eigen::Matrix3f added = at.block;
    for (int axis = 0; axis < 3; ++axis)
      if (std::binary_search(held_.begin(), held_.end(), 4 * node + static_cast<std::size_t>(axis)))
        added.row(axis).setZero(), added.col(axis).setZero();
    point_stiffness_ = std::max(point_stiffness_, static_cast<double>(added.trace() / block.trace()));
    store_inverse(node, block + added);
  }
}

}  // namespace palpate::linear
