#include "linear/mixed_precision/point_operator.h"

#include <algorithm>
#include <utility>

namespace palpate::linear {

void PointOperator::clear() {
  diagonal_.clear();
  row_start_.clear();
}

void PointOperator::take(const dynamics::PointStiffness& points, const std::vector<int>& place_of_node,
                         const NodeOrder& order, double scale) {
  clear();
  if (points.empty()) return;
  blocks_.sum(points, place_of_node);
  order_rows(scale);
  find_parts(order);
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
    diagonal_.push_back({places[r], (scale * own).cast<float>()});
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
  double share = 0.0;
  for (auto r = static_cast<std::size_t>(part_start_[part]);
       r < static_cast<std::size_t>(part_start_[part + 1]); ++r) {
    const int place = diagonal_[r].node;
    const Four own = at(place);
    Four sum = times(single_sum_[r], own);
    for (auto s = static_cast<std::size_t>(row_start_[r]); s < static_cast<std::size_t>(row_start_[r + 1]);
         ++s)
      sum += times(single_[s], at(column_[s]) - own);
    Eigen::Map<Four>(q + 4 * static_cast<std::ptrdiff_t>(place)) += sum;
    share += sum.dot(own);
  }
  return share;
}

void PointOperator::product(std::size_t part, const double* x, double* y) const {
  const auto at = [x](int place) {
    return Eigen::Map<const Vec3>(x + 4 * static_cast<std::ptrdiff_t>(place));
  };
  for (auto r = static_cast<std::size_t>(part_start_[part]);
       r < static_cast<std::size_t>(part_start_[part + 1]); ++r) {
    const int place = diagonal_[r].node;
    const Vec3 own = at(place);
    Vec3 sum = double_sum_[r] * own;
    for (auto s = static_cast<std::size_t>(row_start_[r]); s < static_cast<std::size_t>(row_start_[r + 1]);
         ++s)
      sum += double_[s] * (at(column_[s]) - own);
    Eigen::Map<Vec3>(y + 4 * static_cast<std::ptrdiff_t>(place)) += sum;
  }
}

}  // namespace palpate::linear
