#include "linear/mixed_precision/point_operator.h"

#include <algorithm>
#include <utility>

#include "palpate/core/error.h"

namespace palpate::linear {

void PointOperator::clear() {
  diagonal_.clear();
  own_.clear();
  row_start_.clear();
  border_ = 0;
}

bool PointOperator::take(const dynamics::PointStiffness& points, const dynamics::SparseBorder& border,
                         const std::vector<int>& place_of_node, const NodeOrder& order, double scale) {
  clear();
  if (points.empty()) return true;
  scale_ = scale;
  blocks_.sum(points, place_of_node);
  const bool definite = take_border(border, place_of_node, scale);
  order_rows(scale);
  find_parts(order);
  motion_.resize(static_cast<std::size_t>(order.parts()) * static_cast<std::size_t>(border_));
  sums_.resize(motion_.size());
  double_sums_.resize(motion_.size());
  return definite;
}

bool PointOperator::take_border(const dynamics::SparseBorder& border, const std::vector<int>& place_of_node,
                                double scale) {
  if (border.entries().empty()) return true;
  const std::vector<int>& places = blocks_.places();
  border_ = border.size();
  double_border_.assign(places.size() * static_cast<std::size_t>(border_), Vec3::Zero());
  for (const dynamics::SparseBorder::Entry& entry : border.entries()) {
    const int place = place_of_node[static_cast<std::size_t>(entry.node)];
    const auto at = std::lower_bound(places.begin(), places.end(), place);
    PALPATE_CHECK(at != places.end() && *at == place,
                  "a rigid block is coupled to node {}, which has no contact", entry.node);
    Vec3* const row = double_border_.data() + (at - places.begin()) * border_ + entry.column;
    for (int c = 0; c < 6; ++c)
      row[c] += 0.5 * scale * (entry.right.col(c) + entry.bottom.row(c).transpose());
  }
  single_border_.resize(double_border_.size());
  for (std::size_t k = 0; k < double_border_.size(); ++k)
    single_border_[k] << double_border_[k].cast<float>(), 0.0f;
  S_ = border.corner;
  S_ += border.corner.transpose();
  S_ *= 0.5 * scale;
  llt_.compute(S_);
  S_inverse_.setIdentity(border_, border_);
  if (llt_.info() != Eigen::Success) return false;
  llt_.solveInPlace(S_inverse_);
  return S_inverse_.allFinite();
}

template <>
void PointOperator::rigid_motion(std::size_t part, const float* p, double* motion) const {
  Eigen::Vector4f* const sums = sums_.data() + part * static_cast<std::size_t>(border_);
  std::fill_n(sums, border_, Eigen::Vector4f::Zero());
  const Eigen::Vector4f* B = single_border_.data();
  for (const Diagonal& row : diagonal_) {
    const Eigen::Map<const Eigen::Vector4f> own(p + 4 * static_cast<std::ptrdiff_t>(row.node));
    for (Eigen::Index c = 0; c < border_; ++c) sums[c] += (*B++).cwiseProduct(own);
  }
  for (Eigen::Index c = 0; c < border_; ++c) {
    motion[c] = 0.0;
    for (Eigen::Index k = 0; k < border_; ++k) motion[c] += S_inverse_(k, c) * sums[k].sum();
  }
}

template <>
void PointOperator::rigid_motion(std::size_t part, const double* x, double* motion) const {
  Eigen::Map<VecX> sums(double_sums_.data() + part * static_cast<std::size_t>(border_), border_);
  sums.setZero();
  const Vec3* B = double_border_.data();
  for (const Diagonal& row : diagonal_) {
    const Eigen::Map<const Vec3> own(x + 4 * static_cast<std::ptrdiff_t>(row.node));
    for (Eigen::Index c = 0; c < border_; ++c) sums[c] += (*B++).dot(own);
  }
  Eigen::Map<VecX>(motion, border_).noalias() = S_inverse_ * sums;
}

/// Builds the rows of all off-diagonal blocks, each pair in both of its rows; C_ii = M_i - sum_j C_ij.
void PointOperator::order_rows(double scale) {
  const std::vector<int>& places = blocks_.places();
  const auto single = [scale](const Mat3& C) {
    SingleBlock out = SingleBlock::Zero();
    out.topRows<3>() = (scale * C).cast<float>();
    return out;
  };
  row_start_.assign(places.size() + 1, 0);
  for (const PointBlocks::Pair& pair : blocks_.pairs()) {
    ++row_start_[static_cast<std::size_t>(pair.i) + 1];
    ++row_start_[static_cast<std::size_t>(pair.j) + 1];
  }
  for (std::size_t r = 0; r < places.size(); ++r) row_start_[r + 1] += row_start_[r];
  next_.assign(row_start_.begin(), row_start_.end() - 1);
  const std::size_t count = 2 * blocks_.pairs().size();
  column_.resize(count);
  single_.resize(count);
  double_.resize(count);
  double_sum_.resize(places.size());
  single_sum_.resize(places.size());
  for (const PointBlocks::Pair& pair : blocks_.pairs()) {
    const Mat3 C = PointBlocks::matrix(pair.C);
    const SingleBlock rounded = single(C);
    for (const auto& [row, column] : {std::pair{pair.i, pair.j}, std::pair{pair.j, pair.i}}) {
      const auto s = static_cast<std::size_t>(next_[static_cast<std::size_t>(row)]++);
      column_[s] = places[static_cast<std::size_t>(column)];
      single_[s] = rounded;
      double_[s] = C;
    }
  }
  for (std::size_t r = 0; r < places.size(); ++r) {
    const Mat3 sum = PointBlocks::matrix(blocks_.row_sums()[r]);
    double_sum_[r] = sum;
    single_sum_[r] = single(sum);
    Mat3 own = sum;
    for (auto s = static_cast<std::size_t>(row_start_[r]); s < static_cast<std::size_t>(row_start_[r + 1]);
         ++s)
      own -= double_[s];
    own_.push_back((scale * own).cast<float>());
    Eigen::Matrix3f all = own_.back();
    if (border_ > 0) {
      const Eigen::Map<const Eigen::Matrix3Xd> B(double_border_[r * static_cast<std::size_t>(border_)].data(),
                                                 3, border_);
      Mat3 eliminated = Mat3::Zero();
      for (Eigen::Index c = 0; c < border_; ++c)
        for (Eigen::Index k = 0; k < border_; ++k)
          eliminated.noalias() += S_inverse_(k, c) * B.col(k) * B.col(c).transpose();
      all -= eliminated.cast<float>();
    }
    diagonal_.push_back({places[r], all});
  }
}

void PointOperator::find_parts(const NodeOrder& order) {
  const std::vector<int>& places = blocks_.places();
  part_start_.clear();
  for (std::size_t p = 0; p <= static_cast<std::size_t>(order.parts()); ++p)
    part_start_.push_back(static_cast<int>(
        std::lower_bound(places.begin(), places.end(), order.first_node(p)) - places.begin()));
}

double PointOperator::product(std::size_t part, const float* p, float* q) const {
  using Four = Eigen::Vector4f;
  const auto at = [p](int place) {
    return Eigen::Map<const Four>(p + 4 * static_cast<std::ptrdiff_t>(place));
  };
  const auto times = [](const SingleBlock& C, const Four& d) -> Four {
    return C.col(0) * d[0] + C.col(1) * d[1] + C.col(2) * d[2];
  };
  if (part_start_[part] == part_start_[part + 1]) return 0.0;
  double share = 0.0;
  double* const motion = motion_.data() + part * static_cast<std::size_t>(border_);
  if (border_ > 0) rigid_motion(part, p, motion);
  for (auto r = static_cast<std::size_t>(part_start_[part]);
       r < static_cast<std::size_t>(part_start_[part + 1]); ++r) {
    const int place = diagonal_[r].node;
    const Four own = at(place);
    Four sum = times(single_sum_[r], own);
    for (auto s = static_cast<std::size_t>(row_start_[r]); s < static_cast<std::size_t>(row_start_[r + 1]);
         ++s)
      sum += times(single_[s], at(column_[s]) - own);
    for (Eigen::Index c = 0; c < border_; ++c)
      sum -= single_border_[r * static_cast<std::size_t>(border_) + static_cast<std::size_t>(c)] *
             static_cast<float>(motion[c]);
    Eigen::Map<Four>(q + 4 * static_cast<std::ptrdiff_t>(place)) += sum;
    share += sum.dot(own);
  }
  return share;
}

void PointOperator::product(std::size_t part, const double* x, double* y) const {
  const auto at = [x](int place) {
    return Eigen::Map<const Vec3>(x + 4 * static_cast<std::ptrdiff_t>(place));
  };
  if (part_start_[part] == part_start_[part + 1]) return;
  double* const motion = motion_.data() + part * static_cast<std::size_t>(border_);
  if (border_ > 0) rigid_motion(part, x, motion);
  for (auto r = static_cast<std::size_t>(part_start_[part]);
       r < static_cast<std::size_t>(part_start_[part + 1]); ++r) {
    const int place = diagonal_[r].node;
    const Vec3 own = at(place);
    Vec3 sum = double_sum_[r] * own;
    for (auto s = static_cast<std::size_t>(row_start_[r]); s < static_cast<std::size_t>(row_start_[r + 1]);
         ++s)
      sum += double_[s] * (at(column_[s]) - own);
    for (Eigen::Index c = 0; c < border_; ++c)
      sum -= double_border_[r * static_cast<std::size_t>(border_) + static_cast<std::size_t>(c)] *
             (motion[c] / scale_);
    Eigen::Map<Vec3>(y + 4 * static_cast<std::ptrdiff_t>(place)) += sum;
  }
}

}  // namespace palpate::linear
