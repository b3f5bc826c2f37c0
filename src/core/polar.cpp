#include "palpate/core/polar.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include <limits>
#include <optional>

namespace palpate {
namespace {

/// cof(F) = det(F) F^-T, column by column; needs no inverse and never divides.
Mat3 cofactor(const Mat3& F) {
  Mat3 c;
  c.col(0) = F.col(1).cross(F.col(2));
  c.col(1) = F.col(2).cross(F.col(0));
  c.col(2) = F.col(0).cross(F.col(1));
  return c;
}

/// Newton's method on X^T X = I from X0 = F, scaled after Higham (1986), "Computing the polar decomposition":
///   X <- (g X + X^-T / g) / 2,   g^2 = |X^-1|_F / |X|_F.
/// Each singular value s of X goes to (g s + 1/(g s))/2 while the singular vectors stay, so the limit is R of F = R S.
/// Quadratic: e <- e^2/2, so a step below 1e-8 means that the iterate it led to is orthogonal to rounding.
std::optional<Mat3> newton_rotation(const Mat3& F) {
  constexpr int kMaxIterations = 12;
  constexpr double kStepSquared = 1e-16;
  Mat3 X = F;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Mat3 c = cofactor(X);
    const double det = X.col(0).dot(c.col(0));
    const double g = std::sqrt(std::sqrt(c.squaredNorm() / X.squaredNorm()) / det);
    const Mat3 next = 0.5 * (g * X + c / (g * det));
    const double step = (next - X).squaredNorm();
    X = next;
    if (step < kStepSquared) return X;
  }
  return std::nullopt;
}

/// The cofactors lose digits as (largest / smallest singular value)^2; within these bounds that is harmless, and every
/// element of a mesh in ordinary use is within them.  False for NaN.
bool well_conditioned(const Mat3& F) {
  constexpr double kSmallestDet = 0.05, kLargestNormSquared = 30.0;
  return F.squaredNorm() < kLargestNormSquared && F.determinant() > kSmallestDet;
}

}  // namespace

SignedSvd signed_svd(const Mat3& F) {
  if (!F.allFinite()) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {Mat3::Constant(nan), Vec3::Constant(nan), Mat3::Constant(nan)};
  }
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  SignedSvd out{svd.matrixU(), svd.singularValues(), svd.matrixV()};
  // Reflections go into the smallest singular value: the pair (u2, sigma2) or (v2, sigma2) changes sign together.
  if (out.U.determinant() < 0) {
    out.U.col(2) *= -1;
    out.sigma[2] *= -1;
  }
  if (out.V.determinant() < 0) {
    out.V.col(2) *= -1;
    out.sigma[2] *= -1;
  }
  out.sigma[2] += 0.0;  // -0 becomes +0
  return out;
}

Polar polar_decomposition(const Mat3& F) {
  if (well_conditioned(F)) {
    if (const auto R = newton_rotation(F)) {
      const Mat3 S = R->transpose() * F;
      return {*R, 0.5 * (S + S.transpose())};
    }
  }
  const SignedSvd svd = signed_svd(F);
  const Mat3 S = svd.V * svd.sigma.asDiagonal() * svd.V.transpose();
  return {svd.U * svd.V.transpose(), 0.5 * (S + S.transpose())};
}

}  // namespace palpate
