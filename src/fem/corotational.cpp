#include "corotational.h"

#include <algorithm>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/polar.h"
#include "law.h"

namespace palpate::fem {
namespace {

/// Returns C = c G with bounded eigenvalues: those of G by 1/kSmallestSum, and those of C by `largest`.
Mat3 bounded_coupling(const Mat3& inverse_of_G, double c, double largest, bool& clamped) {
  Eigen::SelfAdjointEigenSolver<Mat3> eigen(inverse_of_G);
  Vec3 values;
  for (int i = 0; i < 3; ++i) {
    const double sum = eigen.eigenvalues()[i];
    if (c >= largest * std::max(sum, kSmallestSum)) {
      values[i] = largest;  // not singular: this bound is reached first
    } else {
      clamped = clamped || sum < kSmallestSum;
      values[i] = c / std::max(sum, kSmallestSum);
    }
  }
  return eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

/// Whether a symmetric matrix is positive definite, by Sylvester's criterion.
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
  // The product of the two larger sums is at most (tr A / 2)^2, so the determinant bounds the smallest sum
  // from below without computing eigenvalues.
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

namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Mat3 rotation_of(const Mat3& F) { return polar_decomposition(F).R; }

double energy_density(const Mat3& F, const Lame& lame) {
  return elastic_energy_density(F, rotation_of(F), lame);
}
Mat3 stress(const Mat3& F, const Lame& lame) { return elastic_stress(F, rotation_of(F), lame); }
Mat3 stress_change(Tangent tangent, const Mat3& F, const Mat3& dF, const Lame& lame) {
  const Mat3 R = rotation_of(F);
  bool clamped = false;
  return elastic_stress_change(dF, R, rotation_coupling(tangent, F, R, lame, clamped), lame);
}

void rotation_by_scalar(const double* F, double* R) {
  Eigen::Map<RowMajor> out(R);
  out = rotation_of(Eigen::Map<const RowMajor>(F));
}

/// Computes C; returns 1 if it was clamped.
int coupling_by_scalar(const ElementModel& model, const double* F, const double* R, double* C) {
  bool clamped = false;
  const Tangent tangent = model.warped      ? Tangent::kWarped
                          : model.projected ? Tangent::kProjected
                                            : Tangent::kExact;
  Eigen::Map<RowMajor> out(C);
  out = rotation_coupling(tangent, Eigen::Map<const RowMajor>(F), Eigen::Map<const RowMajor>(R),
                          {model.mu, model.lambda}, clamped);
  return clamped ? 1 : 0;
}

}  // namespace

namespace laws {
extern const Law corotational;
const Law corotational{
    .summary =
        "corotational elasticity: linear in the rotated frame of each element (Mueller and Gross 2004)",
    .warped = true,
    .nodal_dilatation = true,
    .energy_density = energy_density,
    .stress = stress,
    .stress_change = stress_change,
    .scalar = {rotation_by_scalar, coupling_by_scalar}};
}  // namespace laws

}  // namespace palpate::fem
