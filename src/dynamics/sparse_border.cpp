#include "palpate/dynamics/sparse_border.h"

namespace palpate::dynamics {

void SparseBorder::reset(int node_count, int size) {
  for (const Entry& entry : entries_) first_[static_cast<std::size_t>(entry.node)] = -1;
  entries_.clear();
  first_.resize(size > 0 ? static_cast<std::size_t>(node_count) : 0, -1);
  corner.setZero(size, size);
}

SparseBorder::Entry& SparseBorder::at(int node, int column) {
  int& first = first_[static_cast<std::size_t>(node)];
  for (int k = first; k >= 0; k = entries_[static_cast<std::size_t>(k)].next)
    if (entries_[static_cast<std::size_t>(k)].column == column) return entries_[static_cast<std::size_t>(k)];
  entries_.push_back(
      {node, column, Eigen::Matrix<double, 3, 6>::Zero(), Eigen::Matrix<double, 6, 3>::Zero(), first});
  first = static_cast<int>(entries_.size()) - 1;
  return entries_.back();
}

void SparseBorder::add_right_product(const VecX& x, double by, VecX& y) const {
  const Eigen::Index nodal = y.size() - size();
  for (const Entry& e : entries_) y.segment<3>(3 * e.node) += by * (e.right * x.segment<6>(nodal + e.column));
}

void SparseBorder::add_bottom_product(const VecX& x, double by, VecX& y_b) const {
  for (const Entry& e : entries_) y_b.segment<6>(e.column) += by * (e.bottom * x.segment<3>(3 * e.node));
}

}  // namespace palpate::dynamics
