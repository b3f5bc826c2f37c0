#include "corotated.h"

#include <algorithm>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace palpate::fem {
namespace {

double double_dot(const Mat3& A, const Mat3& B) { return A.cwiseProduct(B).sum(); }

/// C = c G with its eigenvalues bounded: those of G by 1/kSmallestSum, and those of C by `largest`.
Mat3 bounded_coupling(const Mat3& inverse_of_G, double c, double largest, bool& clamped) {
  Eigen::SelfAdjointEigenSolver<Mat3> eigen(inverse_of_G);
  Vec3 values;
  for (int i = 0; i < 3; ++i) {
    const double sum = eigen.eigenvalues()[i];
    if (c >= largest * std::max(sum, kSmallestSum)) {
      values[i] = largest;  // no singularity: the bound acts before it
    } else {
      clamped = clamped || sum < kSmallestSum;
      values[i] = c / std::max(sum, kSmallestSum);
    }
  }
  return eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

/// Sylvester's criterion.
bool positive_definite(const Mat3& m) {
  return m(0, 0) > 0.0 && m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0) > 0.0 && m.determinant() > 0.0;
}

}  // namespace

double elastic_energy_density(const Mat3& F, const Mat3& R, const Lame& lame) {
  const double trace = double_dot(R, F) - 3.0;
  return lame.mu * (F - R).squaredNorm() + 0.5 * lame.lambda * trace * trace;
}

Mat3 elastic_stress(const Mat3& F, const Mat3& R, const Lame& lame) {
  return 2.0 * lame.mu * (F - R) + lame.lambda * (double_dot(R, F) - 3.0) * R;
}

Mat3 rotation_coupling(Tangent tangent, const Mat3& F, const Mat3& R, const Lame& lame, bool& clamped) {
  if (tangent == Tangent::kWarped) return lame.mu * Mat3::Identity();
  const Mat3 FRt = F * R.transpose();
  const Mat3 B = 0.5 * (FRt + FRt.transpose());
  const double c = 2.0 * lame.mu - lame.lambda * (B.trace() - 3.0);
  const Mat3 A = B.trace() * Mat3::Identity() - B;  // G^-1: eigenvalues s_i + s_j >= 0
  // The product of the two larger sums is at most (tr A / 2)^2, so this bounds the smallest from below,
  // without eigenvalues.
  const double half_trace = 0.5 * A.trace();
  const bool regular = A.determinant() > kSmallestSum * half_trace * half_trace;
  const bool exact = tangent == Tangent::kExact;
  if (regular && (exact || positive_definite(lame.mu * A - c * Mat3::Identity()))) {
    const Mat3 C = c * A.inverse();
    return 0.5 * (C + C.transpose());
  }
  const double unbounded = std::numeric_limits<double>::max();
  return bounded_coupling(A, c, exact ? unbounded : lame.mu, clamped);
}

void add_elastic_blocks(const Mat3& gradients, const Mat3& R, const Mat3& C, const Lame& lame, double scale,
                        ElementBlocks& K) {
  const Mat3 H = R * gradients.transpose();  // columns h_a
  const Mat3 gram = gradients * gradients.transpose();
  for (int a = 0; a < 3; ++a) {
    const Mat3 hC = cross_matrix(H.col(a)) * C;
    for (int b = a; b < 3; ++b) {
      Mat3 block = lame.lambda * H.col(a) * H.col(b).transpose() + hC * cross_matrix(H.col(b));
      block.diagonal().array() += 2.0 * lame.mu * gram(a, b);
      K[static_cast<std::size_t>(3 * a + b)] += scale * block;
      if (b > a) K[static_cast<std::size_t>(3 * b + a)] += scale * block.transpose();
    }
  }
}

Mat3 elastic_stress_change(const Mat3& dF, const Mat3& R, const Mat3& C, const Lame& lame) {
  const Mat3 M = dF * R.transpose();
  const Vec3 axial(M(2, 1) - M(1, 2), M(0, 2) - M(2, 0), M(1, 0) - M(0, 1));  // axl(M - M^T)
  return 2.0 * lame.mu * dF + lame.lambda * M.trace() * R - cross_matrix(C * axial) * R;
}

Mat3 strain_rate(const Mat3& F, const Mat3& F_dot) {
  const Mat3 M = F.transpose() * F_dot;
  return 0.5 * (M + M.transpose());
}

Mat3 damping_stress(const Mat3& rate, const Lame& damping) {
  Mat3 sigma = 2.0 * damping.mu * rate;
  sigma.diagonal().array() += damping.lambda * rate.trace();
  return sigma;
}

void add_damping_blocks(const Mat3& gradients, const Mat3& F, const Lame& damping, double scale,
                        ElementBlocks& D) {
  const Mat3 k = F * gradients.transpose();  // columns k_a
  const Mat3 gram = gradients * gradients.transpose();
  const Mat3 B2 = F * F.transpose();
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b) {
      const Mat3 outer = k.col(a) * k.col(b).transpose();
      const Mat3 block = damping.mu * (gram(a, b) * B2 + outer.transpose()) + damping.lambda * outer;
      D[static_cast<std::size_t>(3 * a + b)] += scale * block;
      if (b > a) D[static_cast<std::size_t>(3 * b + a)] += scale * block.transpose();
    }
}

void add_damping_position_blocks(const Mat3& gradients, const Mat3& F, const Mat3& F_dot, const Lame& damping,
                                 double scale, ElementBlocks& K) {
  const Mat3 k = F * gradients.transpose(), l = F_dot * gradients.transpose();
  const Mat3 gram = gradients * gradients.transpose();
  // g_a . Sigma g_b
  const Mat3 geometric = gradients * damping_stress(strain_rate(F, F_dot), damping) * gradients.transpose();
  const Mat3 FFdot = F * F_dot.transpose();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      Mat3 block = damping.mu * (gram(a, b) * FFdot + k.col(b) * l.col(a).transpose()) +
                   damping.lambda * k.col(a) * l.col(b).transpose();
      block.diagonal().array() += geometric(a, b);
      K[static_cast<std::size_t>(3 * a + b)] += scale * block;
    }
}

}  // namespace palpate::fem
