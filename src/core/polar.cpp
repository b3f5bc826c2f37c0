#include "core/polar.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace palpate {
namespace {

/// Returns cof(F) = det(F) F^-T, column by column; needs no inverse and no division.
Mat3 cofactor(const Mat3& F) {
  Mat3 c;
  c.col(0) = F.col(1).cross(F.col(2));
  c.col(1) = F.col(2).cross(F.col(0));
  c.col(2) = F.col(0).cross(F.col(1));
  return c;
}

/// Newton's method on X^T X = I from X0 = F, scaled after Higham (1986), "Computing the polar decomposition":
///   X <- (g X + X^-T / g) / 2,   g^2 = |X^-1|_F / |X|_F.
/// Each singular value s of X becomes (g s + 1/(g s))/2 while the singular vectors are unchanged, so the
/// limit is R of F = R S.  Convergence is quadratic, e <- e^2/2, so after a step below 1e-8 the iterate is
/// orthogonal to rounding.
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

/// Whether F is within bounds where cofactors are accurate.  They lose digits as (largest / smallest singular
/// value)^2; within these bounds the loss is harmless, and every element of a mesh in ordinary use is within
/// them.  False for NaN.
bool well_conditioned(const Mat3& F) {
  constexpr double kSmallestDet = 0.05, kLargestNormSquared = 30.0;
  return F.squaredNorm() < kLargestNormSquared && F.determinant() > kSmallestDet;
}

/// One-sided Jacobi (Hestenes): rotates pairs of columns of B = F V until all are orthogonal.  Works on F
/// itself, not on F^T F, so that small singular values keep their digits.
void orthogonalise_columns(Mat3& B, Mat3& V) {
  constexpr int kMaxSweeps = 30;  // Quadratic convergence: 4 to 6 are usual.
  constexpr double kRelative = 4 * std::numeric_limits<double>::epsilon(), kAbsolute = 1e-80;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    bool rotated = false;
    for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
      const double a = B.col(p).squaredNorm(), b = B.col(q).squaredNorm(), c = B.col(p).dot(B.col(q));
      if (std::abs(c) <= kRelative * std::sqrt(a * b) + kAbsolute) continue;
      const double z = (b - a) / (2 * c);
      const double t = std::copysign(1.0, z) / (std::abs(z) + std::sqrt(1 + z * z));
      const double cosine = 1 / std::sqrt(1 + t * t), sine = cosine * t;
      for (Mat3* m : {&B, &V}) {
        const Vec3 old = m->col(p);
        m->col(p) = cosine * old - sine * m->col(q);
        m->col(q) = sine * old + cosine * m->col(q);
      }
      rotated = true;
    }
    if (!rotated) return;
  }
}

/// Sorts columns of B by descending length; a swap negates one column, so that V stays proper.
void sort_columns(Mat3& B, Mat3& V) {
  for (const auto& [p, q] : {std::pair{0, 1}, std::pair{1, 2}, std::pair{0, 1}}) {
    if (B.col(p).squaredNorm() >= B.col(q).squaredNorm()) continue;
    for (Mat3* m : {&B, &V}) {
      const Vec3 old = m->col(p);
      m->col(p) = m->col(q);
      m->col(q) = -old;
    }
  }
}

}  // namespace

// U is completed as (u0, u1, u0 x u1), hence proper, and the sign of the smallest singular value follows:
// sigma2 = u2 . (F v2).
SignedSvd signed_svd(const Mat3& F) {
  const double scale = F.cwiseAbs().maxCoeff();
  if (!F.allFinite()) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {Mat3::Constant(nan), Vec3::Constant(nan), Mat3::Constant(nan)};
  }
  if (scale < std::numeric_limits<double>::min()) return {Mat3::Identity(), Vec3::Zero(), Mat3::Identity()};

  constexpr double kRankOne = 1e-30;  // Far below rounding: such a column has no meaningful direction.
  Mat3 B = F / scale, V = Mat3::Identity();
  orthogonalise_columns(B, V);
  sort_columns(B, V);
  const Vec3 u0 = B.col(0).normalized();
  const Vec3 rest = B.col(1) - u0 * u0.dot(B.col(1));
  const Vec3 u1 = rest.norm() > kRankOne ? rest.normalized() : u0.unitOrthogonal();
  const Vec3 u2 = u0.cross(u1);
  const double s0 = B.col(0).norm(), s1 = std::min(B.col(1).norm(), s0),
               s2 = std::clamp(u2.dot(B.col(2)), -s1, s1);
  SignedSvd out;
  out.U << u0, u1, u2;
  out.sigma = scale * Vec3(s0, s1, s2);
  out.V = V;
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
