#include "integrate/sundials/multirate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

#include "integrate/multirate.h"
#include "integrate/sundials/check.h"
#include "palpate/core/error.h"

// One step H of a multi-rate infinitesimal method (Sandu 2019) starts from z_1 = y_n. With its abscissae c_i
// and coupling coefficients g_ij(tau) = sum_k G^k_ij tau^k, each stage is
//     c_i > c_(i-1):  v' = F v + H/T sum_j g_ij(s/T) S z_j  from  v(0) = z_(i-1),  T = (c_i - c_(i-1)) H,
//                     z_i = v(T)
//     c_i = c_(i-1):  z_i = z_(i-1) + H sum_j gbar_ij S z_j,    gbar_ij = sum_k G^k_ij/(k + 1)
// and the last z is y_(n+1). With  integral_0^T e^(F (T - s)) (s/T)^k ds = T k! phi_(k+1)(T F),
//     z_i = e^(T F) z_(i-1) + H sum_jk G^k_ij k! phi_(k+1)(T F) S z_j.
// phi_1 .. phi_m of X are in the first block row of exp of the block matrix with X, 1, 0, .. in its first row
// and ones above its diagonal (Saad 1992):
//     exp [X 1 0; 0 0 1; 0 0 0] = [e^X phi_1 phi_2; ..].
// Every z_i = Z_i y_n, and the last Z is the matrix of the step.

namespace palpate::integrate {
namespace sun {
namespace {

constexpr MultirateMethod kMethods[] = {{"ark-mri-2", ARKODE_MRI_GARK_IRK21a, 2},
                                        {"ark-mri-3", ARKODE_MRI_GARK_ESDIRK34a, 3},
                                        {"ark-mri-4", ARKODE_MRI_GARK_ESDIRK46a, 4}};

/// c and G^k of a coupling table.
struct Coupling {
  VecX c;
  std::vector<MatX> G;

  explicit Coupling(const MultirateMethod& method) {
    MRIStepCoupling table = MRIStepCoupling_LoadTable(method.table);
    check(table, "MRIStepCoupling_LoadTable");
    c = Eigen::Map<const VecX>(table->c, table->stages);
    for (int k = 0; k < table->nmat; ++k) {
      G.emplace_back(table->stages, table->stages);
      for (int i = 0; i < table->stages; ++i)
        for (int j = 0; j < table->stages; ++j) G.back()(i, j) = table->G[k][i][j];
    }
    MRIStepCoupling_Free(table);
  }
};

/// Returns e^X, phi_1(X), .., phi_m(X).
std::vector<MatX> phi_functions(const MatX& X, int m) {
  const Eigen::Index n = X.rows();
  MatX block = MatX::Zero(n * (m + 1), n * (m + 1));
  block.topLeftCorner(n, n) = X;
  for (int k = 0; k < m; ++k) block.block(k * n, (k + 1) * n, n, n).setIdentity();
  const MatX exponential = block.exp();
  std::vector<MatX> phi;
  for (int k = 0; k <= m; ++k) phi.push_back(exponential.block(0, k * n, n, n));
  return phi;
}

MatX step_matrix(const Coupling& coupling, const MatX& slow, const MatX& fast, double H) {
  const Eigen::Index n = slow.rows();
  std::vector<MatX> Z = {MatX::Identity(n, n)}, f = {slow};  // f_j = S Z_j
  for (Eigen::Index i = 1; i < coupling.c.size(); ++i) {
    const double T = (coupling.c[i] - coupling.c[i - 1]) * H;
    MatX z = Z.back();
    if (T > 0.0) {
      const std::vector<MatX> phi = phi_functions(T * fast, static_cast<int>(coupling.G.size()));
      z = phi[0] * z;
      double factorial = 1.0;
      for (std::size_t k = 0; k < coupling.G.size(); ++k) {
        if (k > 0) factorial *= static_cast<double>(k);
        MatX sum = MatX::Zero(n, n);
        for (std::size_t j = 0; j < f.size(); ++j)
          sum += coupling.G[k](i, static_cast<Eigen::Index>(j)) * f[j];
        z += H * factorial * (phi[k + 1] * sum);
      }
    } else {
      double own = 0.0;
      for (std::size_t k = 0; k < coupling.G.size(); ++k) {
        const double weight = 1.0 / (static_cast<double>(k) + 1.0);
        for (std::size_t j = 0; j < f.size(); ++j)
          z += H * weight * coupling.G[k](i, static_cast<Eigen::Index>(j)) * f[j];
        own += weight * coupling.G[k](i, i);
      }
      z = (MatX::Identity(n, n) - H * own * slow).lu().solve(z).eval();
    }
    f.push_back(slow * z);
    Z.push_back(std::move(z));
  }
  return Z.back();
}

}  // namespace

const MultirateMethod& multirate_method(std::string_view name) {
  const auto* m = std::find_if(std::begin(kMethods), std::end(kMethods),
                               [&](const MultirateMethod& x) { return name == x.name; });
  if (m == std::end(kMethods)) fail("\"{}\" is not a multi-rate method", name);
  return *m;
}

MatX multirate_step(std::string_view method, const MatX& slow, const MatX& fast, double step_s) {
  return step_matrix(Coupling(multirate_method(method)), slow, fast, step_s);
}

}  // namespace sun

double multirate_amplification(std::string_view method, const MatX& slow, const MatX& fast, double step_s) {
  if (slow.rows() != slow.cols() || fast.rows() != slow.rows() || fast.cols() != slow.cols())
    fail("the slow matrix is {} x {} and the fast one {} x {}; both must be square and of the same size",
         slow.rows(), slow.cols(), fast.rows(), fast.cols());
  return sun::multirate_step(method, slow, fast, step_s).eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace palpate::integrate
