#include <Eigen/Eigenvalues>

#include "fem/law.h"

namespace palpate::fem {
namespace {

// Saint Venant and Kirchhoff: linear elasticity of the Green strain E = (F^T F - I)/2,
//     psi = mu |E|^2 + lambda/2 tr(E)^2,   P = F S,   S = 2 mu E + lambda tr(E) I,
//     dP = dF S + F (2 mu dE + lambda tr(dE) I),   dE = sym(F^T dF).
// It softens under compression and does not resist inversion.

Mat3 strain(const Mat3& F) { return 0.5 * (F.transpose() * F - Mat3::Identity()); }

Mat3 of_strain(const Mat3& E, const Lame& lame) {
  return 2.0 * lame.mu * E + lame.lambda * E.trace() * Mat3::Identity();
}

double energy_density(const Mat3& F, const Lame& lame) {
  const Mat3 E = strain(F);
  return lame.mu * E.squaredNorm() + 0.5 * lame.lambda * E.trace() * E.trace();
}

Mat3 stress(const Mat3& F, const Lame& lame) { return F * of_strain(strain(F), lame); }

Mat3 exact_change(const Mat3& F, const Mat3& dF, const Lame& lame) {
  const Mat3 FtdF = F.transpose() * dF;
  return dF * of_strain(strain(F), lame) + F * of_strain(0.5 * (FtdF + FtdF.transpose()), lame);
}

/// Projected: negative eigenvalues of the 9x9 derivative become 0.
Mat3 stress_change(Tangent tangent, const Mat3& F, const Mat3& dF, const Lame& lame) {
  if (tangent == Tangent::kExact) return exact_change(F, dF, lame);
  using Mat9 = Eigen::Matrix<double, 9, 9>;
  Mat9 H;
  for (int i = 0; i < 9; ++i) {
    Mat3 unit = Mat3::Zero();
    unit(i % 3, i / 3) = 1.0;
    H.col(i) = exact_change(F, unit, lame).reshaped();
  }
  const Eigen::SelfAdjointEigenSolver<Mat9> eigen(0.5 * (H + H.transpose()));
  const Eigen::Matrix<double, 9, 1> in_modes = eigen.eigenvectors().transpose() * dF.reshaped();
  const Eigen::Matrix<double, 9, 1> out =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseProduct(in_modes);
  return out.reshaped(3, 3);
}

}  // namespace

namespace laws {
extern const Law saint_venant;
const Law saint_venant{.summary = "linear elasticity of the Green strain (Saint Venant and Kirchhoff)",
                       .warped = false,
                       .nodal_dilatation = false,
                       .energy_density = energy_density,
                       .stress = stress,
                       .stress_change = stress_change,
                       .scalar = {nullptr, nullptr}};
}  // namespace laws

}  // namespace palpate::fem
