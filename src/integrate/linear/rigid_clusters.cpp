#include "integrate/linear/rigid_clusters.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::integrate {

void RigidClusters::prepare(const NodeOrder& order) {
  ready_ = false;
  size_ = 6 * order.clusters();
  stride_ = (size_ + 15) / 16 * 16;
  cluster_.resize(order.node.size());
  for (int c = 0; c < order.clusters(); ++c)
    std::fill(cluster_.begin() + order.start[static_cast<std::size_t>(c)], cluster_.begin() + order.start[static_cast<std::size_t>(c) + 1], c);
  arm_.assign(4 * order.node.size() + kVectorTail, 0.0f);
  E_.assign(static_cast<std::size_t>(size_) * static_cast<std::size_t>(stride_), 0.0f);
}

/// In units of the cluster's mean radius, so that E's rows of forces and of moments are of one size.
void RigidClusters::place_arms(const NodeOrder& order, const double* positions) {
  for (int c = 0; c < order.clusters(); ++c) {
    const auto first = static_cast<std::size_t>(order.start[static_cast<std::size_t>(c)]), last = static_cast<std::size_t>(order.start[static_cast<std::size_t>(c) + 1]);
    const auto position = [&](std::size_t k) -> Vec3 { return positions ? Vec3(Eigen::Map<const Vec3>(positions + 3 * static_cast<std::size_t>(order.node[k]))) : Vec3::Zero(); };
    Vec3 centre = Vec3::Zero();
    for (std::size_t k = first; k < last; ++k) centre += position(k) / static_cast<double>(last - first);
    double square = 0.0;
    for (std::size_t k = first; k < last; ++k) square += (position(k) - centre).squaredNorm() / static_cast<double>(last - first);
    const double by = square > 0.0 && std::isfinite(square) ? 1.0 / std::sqrt(square) : 0.0;
    for (std::size_t k = first; k < last; ++k) {
      const Vec3 arm = by * (position(k) - centre);
      for (int axis = 0; axis < 3; ++axis) arm_[4 * k + static_cast<std::size_t>(axis)] = by > 0.0 ? static_cast<float>(arm[axis]) : 0.0f;
      arm_[4 * k + 3] = 1.0f;
    }
  }
}

/// A held direction's row is that of the identity: a node that hangs on nothing along some axis moves with no cluster.
void RigidClusters::leave_out_held(const SingleMatrix& A) {
  const auto leave_out = [&](std::size_t node) { std::fill_n(arm_.begin() + 4 * static_cast<std::ptrdiff_t>(node), 4, 0.0f); };
  for (const std::size_t entry : A.held()) leave_out(entry / 4);
  for (std::size_t i = 0; i < cluster_.size(); ++i) {
    std::array<float, 3> coupling{};
    for (int s = A.row_start()[i] + 1; s < A.row_start()[i + 1]; ++s)
      for (int k = 0; k < 9; ++k) coupling[static_cast<std::size_t>(k % 3)] += std::abs(A.packing().entry(static_cast<std::size_t>(s), k % 3, k / 3));
    if (*std::min_element(coupling.begin(), coupling.end()) == 0.0f) leave_out(i);
  }
}

/// E_IJ = sum over i in I, j in J of T_i^T A_ij T_j with T_i = [I, -[arm_i]x]: for each row first G = sum_j A_ij T_j, then T_i^T G.
void RigidClusters::assemble(const SingleMatrix& A) {
  const std::vector<int>&row_start = A.row_start(), &column = A.column();
  using Single3 = Eigen::Matrix3f;
  const auto skew = [&](std::size_t i) {
    const float *a = arm_.data() + 4 * i;
    Single3 m;
    m << 0.0f, -a[2], a[1], a[2], 0.0f, -a[0], -a[1], a[0], 0.0f;
    return m;
  };
  std::fill(E_.begin(), E_.end(), 0.0f);
  for (std::size_t i = 0; i < cluster_.size(); ++i) {
    if (arm_[4 * i + 3] == 0.0f) continue;
    const int I = cluster_[i];
    const Single3 turn = skew(i);
    for (int s = row_start[i]; s < row_start[i + 1];) {
      const int J = cluster_[static_cast<std::size_t>(column[static_cast<std::size_t>(s)])];
      Single3 force = Single3::Zero(), moment = Single3::Zero();
      for (; s < row_start[i + 1] && cluster_[static_cast<std::size_t>(column[static_cast<std::size_t>(s)])] == J; ++s) {
        const auto j = static_cast<std::size_t>(column[static_cast<std::size_t>(s)]);
        if (arm_[4 * j + 3] == 0.0f) continue;
        Single3 block;
        for (int k = 0; k < 9; ++k) block(k % 3, k / 3) = A.packing().entry(static_cast<std::size_t>(s), k % 3, k / 3);
        force += block;
        moment.noalias() -= block * skew(j);
      }
      if (J < I) continue;  // the other triangle follows
      Eigen::Map<Eigen::Matrix<float, 6, 6, Eigen::RowMajor>, 0, Eigen::OuterStride<>> E(
          E_.data() + static_cast<std::size_t>(6 * I) * static_cast<std::size_t>(stride_) + static_cast<std::size_t>(6 * J), Eigen::OuterStride<>(stride_));
      E.topLeftCorner<3, 3>() += force;
      E.topRightCorner<3, 3>() += moment;
      E.bottomLeftCorner<3, 3>().noalias() += turn * force;
      E.bottomRightCorner<3, 3>().noalias() += turn * moment;
    }
  }
  for (std::size_t r = 0; r < static_cast<std::size_t>(size_); ++r)
    for (std::size_t c = r / 6 * 6 + 6; c < static_cast<std::size_t>(size_); ++c) E_[c * static_cast<std::size_t>(stride_) + r] = E_[r * static_cast<std::size_t>(stride_) + c];
}

bool RigidClusters::refresh(const SingleMatrix& A, const double* positions, const NodeKernels& kernels) {
  place_arms(A.order(), positions);
  leave_out_held(A);
  assemble(A);
  // A direction that no node moves in (a cluster held whole, a turn without arms) stands alone; a tiny share of the diagonal covers rounding in the
  // turn of a cluster whose nodes lie on a line.
  for (std::size_t k = 0; k < static_cast<std::size_t>(size_); ++k) {
    float& own = E_[k * static_cast<std::size_t>(stride_) + k];
    own = own > 0.0f ? own * (1.0f + 1e-5f) : 1.0f;
  }
  return ready_ = kernels.invert(E_.data(), size_, stride_);
}

}  // namespace palpate::integrate
