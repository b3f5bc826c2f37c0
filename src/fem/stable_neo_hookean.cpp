#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/polar.h"
#include "law.h"

// Stable neo-Hookean (Smith, de Goes and Kim 2018, "Stable Neo-Hookean Flesh Simulation", ACM Trans. Graphics
// 37(2), eq. 14), with I = |F|^2, J = det F and the constants m, l of this law:
//
//   Psi = m/2 (I - 3) + l/2 (J - alpha)^2 - m/2 log(I + 1),     alpha = 1 + 3 m / (4 l).
//
// alpha makes F = 1 stress-free. Without the logarithm (their eq. 13, alpha = 1 + m/l) F = 0 would be a local
// minimum: Psi(s 1) = 3/2 m s^2 + O(s^3) there, and an element that has collapsed to a point stays collapsed.
// With it Psi(s 1) - Psi(0) = -(l + 3/4 m) s^3 + O(s^4): the point is unstable. Hence the whole form is used.
// Flat and inverted elements are driven back as well: at a flat F with stretches s1, s2, 0 the derivative by
// the third is -(l + 3/4 m) s1 s2 < 0. There is no singularity: Psi is smooth for every F.
//
// Shifted to zero at rest and without alpha, with (J - alpha)^2 = (J - 1)^2 - 3 m/(2 l) (J - 1) + const:
//
//   Psi = m/2 (I - 3 - log((I + 1)/4)) - 3/4 m (J - 1) + l/2 (J - 1)^2.
//
// With G = cof F = dJ/dF,
//
//   P = a F + d G,     a = m - m/(I + 1),   d = l (J - 1) - 3/4 m,
//   dP = a dF + b (F : dF) F + l (G : dF) G + d dG,     b = 2 m/(I + 1)^2,
//
// where dG is linear in dF. Nodes: for dF = w g_b^T, with k = F g, n = G g, and u . (dG g_a) for dG of w
// g_b^T the coefficient of s t in det(F + s u g_a^T + t w g_b^T), (u x w) . F (g_a x g_b),
//
//   K_ab = V ( a (g_a . g_b) 1 + b k_a k_b^T + l n_a n_b^T - d [F (g_a x g_b)]x ).
//
// No rotation of F is needed for force, energy or exact tangent.
//
// Lame constants. At F = 1: a = 3/4 m, d = -3/4 m, b = m/8, dG = tr(dF) 1 - dF^T, so that a
// symmetric dF yields dP = 3/2 m dF + (l - 5/8 m) tr(dF) 1, and a skew one zero. This is linear
// elasticity, 2 mu dF + lambda tr(dF) 1, with
//
//   m = 4/3 mu,   l = lambda + 5/6 mu      (their section 3.4),
//
// positive for every Poisson's ratio in (-1, 1/2), where lambda > -2/3 mu.
//
// Eigensystem (their section 4). With the signed singular values F = U diag(s) V^T, det U = det V = 1
// (Irving, Teran and Fedkiw 2004), dG for U X V^T is U (.) V^T of dG for the diagonal matrix and X. So for
// each k, with i and j the other two,
//
//   twist  U (e_i e_j^T - e_j e_i^T) V^T / sqrt 2     eigenvalue a + d s_k,
//   flip   U (e_i e_j^T + e_j e_i^T) V^T / sqrt 2     eigenvalue a - d s_k,
//
// F and G being diagonal there; and three stretches U diag(q) V^T with q an eigenvector of
//
//   A = a 1 + b s s^T + l c c^T + d H,   c_k = s_i s_j,   H_ij = s_k, H_ii = 0.
//
// The projected tangent adds -e M M^T to dP/dF for each of the nine modes M with a negative eigenvalue e,
// which yields the nearest positive semi-definite matrix.

namespace palpate::fem {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Mat3 cofactors(const Mat3& F) {
  Mat3 G;
  for (int i = 0; i < 3; ++i) G.col(i) = F.col((i + 1) % 3).cross(F.col((i + 2) % 3));
  return G;
}

/// Returns d cof(F) for a direction dF.
Mat3 cofactor_change(const Mat3& F, const Mat3& dF) {
  Mat3 dG;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    dG.col(i) = dF.col(j).cross(F.col(k)) + F.col(j).cross(dF.col(k));
  }
  return dG;
}

/// Constants of the derivation at one F.
struct Coefficients {
  double m, l, a, b, d;
  Coefficients(const Lame& lame, double I, double J) {
    m = 4.0 / 3.0 * lame.mu;
    l = lame.lambda + 5.0 / 6.0 * lame.mu;
    a = m - m / (I + 1.0);
    b = 2.0 * m / ((I + 1.0) * (I + 1.0));
    d = l * (J - 1.0) - 0.75 * m;
  }
};

/// Mode of the Hessian with a negative eigenvalue.
struct Mode {
  double deficit;  ///< minus the eigenvalue
  RowMajor M;
};

/// Computes the modes with negative eigenvalues; returns their number.
int negative_modes(const Mat3& F, const Lame& lame, Mode* modes) {
  const SignedSvd svd = signed_svd(F);
  const Vec3& s = svd.sigma;
  const Vec3 c(s[1] * s[2], s[2] * s[0], s[0] * s[1]);
  const Coefficients at(lame, s.squaredNorm(), s.prod());
  int count = 0;
  const auto check = [&](double eigenvalue, const Mat3& X) {
    if (eigenvalue < 0.0) modes[count++] = {-eigenvalue, svd.U * X * svd.V.transpose()};
  };
  Mat3 A = at.b * s * s.transpose() + at.l * c * c.transpose();
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    Mat3 X = Mat3::Zero();
    X(i, j) = X(j, i) = std::sqrt(0.5);
    check(at.a - at.d * s[k], X);
    X(j, i) *= -1.0;
    check(at.a + at.d * s[k], X);
    A(k, k) += at.a;
    A(i, j) += at.d * s[k];
    A(j, i) += at.d * s[k];
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(A);
  for (int i = 0; i < 3; ++i)
    check(eigen.eigenvalues()[i], Vec3(eigen.eigenvectors().col(i)).asDiagonal().toDenseMatrix());
  return count;
}

double energy_density(const Mat3& F, const Lame& lame) {
  const double I = F.squaredNorm(), J = F.determinant();
  const Coefficients at(lame, I, J);
  return 0.5 * at.m * (I - 3.0 - std::log1p(0.25 * (I - 3.0))) - 0.75 * at.m * (J - 1.0) +
         0.5 * at.l * (J - 1.0) * (J - 1.0);
}

Mat3 stress(const Mat3& F, const Lame& lame) {
  const Coefficients at(lame, F.squaredNorm(), F.determinant());
  return at.a * F + at.d * cofactors(F);
}

Mat3 stress_change(Tangent tangent, const Mat3& F, const Mat3& dF, const Lame& lame) {
  const Coefficients at(lame, F.squaredNorm(), F.determinant());
  const Mat3 G = cofactors(F);
  Mat3 dP =
      at.a * dF + at.b * double_dot(F, dF) * F + at.l * double_dot(G, dF) * G + at.d * cofactor_change(F, dF);
  if (tangent == Tangent::kExact) return dP;
  Mode modes[9];
  const int count = negative_modes(F, lame, modes);
  for (int i = 0; i < count; ++i) dP += modes[i].deficit * double_dot(modes[i].M, dF) * modes[i].M;
  return dP;
}

/// Computes the modes that a projected tangent adds, ten numbers each: deficit, then M row by row. Returns
/// their number.
int projection(const ElementModel& model, const double* F, const double*, double* out) {
  const Mat3 one_F = Eigen::Map<const RowMajor>(F);
  if (!one_F.allFinite()) {  // no decomposition: the tangent becomes NaN
    out[0] = std::numeric_limits<double>::quiet_NaN();
    Eigen::Map<RowMajor>(out + 1).setIdentity();
    return 1;
  }
  Mode modes[9];
  const int count = negative_modes(one_F, {model.mu, model.lambda}, modes);
  for (int i = 0; i < count; ++i) {
    out[10 * i] = modes[i].deficit;
    Eigen::Map<RowMajor>(out + 10 * i + 1) = modes[i].M;
  }
  return count;
}

}  // namespace

namespace laws {
extern const Law stable_neo_hookean;
const Law stable_neo_hookean{
    .summary = "neo-Hookean elasticity, stable for flat and inverted elements (Smith, de Goes and Kim 2018)",
    .warped = false,
    .nodal_dilatation = false,
    .energy_density = energy_density,
    .stress = stress,
    .stress_change = stress_change,
    .scalar = {nullptr, projection}};
}  // namespace laws

}  // namespace palpate::fem
