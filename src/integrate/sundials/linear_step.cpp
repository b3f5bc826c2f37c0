#include "palpate/integrate/linear_step.h"

#include <cstdio>  // SUNDIALS 6.4 forgets it: arkode_butcher.h names FILE

#include <arkode/arkode_butcher_dirk.h>
#include <arkode/arkode_butcher_erk.h>

#include <Eigen/LU>
#include <algorithm>
#include <vector>

#include "integrate/sundials/ark_methods.h"
#include "integrate/sundials/check.h"
#include "integrate/sundials/multirate.h"
#include "palpate/core/error.h"

namespace palpate::integrate {
namespace {

// In extended precision: with entries of |Z| = y the sum over the stages cancels to 1/y of its terms.
using MatL = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// Stage by stage: every table here is lower triangular, Y_i = (1 - a_ii Z)^-1 (1 + sum_(j<i) a_ij Z Y_j).
MatX runge_kutta_step(ARKodeButcherTable table, const MatX& Z) {
  const Eigen::Index n = Z.rows();
  const MatL z = Z.cast<long double>(), one = MatL::Identity(n, n);
  MatL step = one;
  std::vector<MatL> rates;  // Z Y_j
  for (int i = 0; i < table->stages; ++i) {
    MatL stage = one;
    for (std::size_t j = 0; j < rates.size(); ++j)
      stage += static_cast<long double>(table->A[i][j]) * rates[j];
    const auto own = static_cast<long double>(table->A[i][i]);
    rates.push_back(z * (one - own * z).eval().partialPivLu().solve(stage));
    step += static_cast<long double>(table->b[i]) * rates.back();
  }
  return step.cast<double>();
}

MatX runge_kutta_step(const ArkMethod& method, const MatX& Z) {
  ARKodeButcherTable table =
      method.implicit_table >= 0
          ? ARKodeButcherTable_LoadDIRK(static_cast<ARKODE_DIRKTableID>(method.implicit_table))
          : ARKodeButcherTable_LoadERK(static_cast<ARKODE_ERKTableID>(method.explicit_table));
  sun::check(table, "ARKodeButcherTable_Load");
  const MatX step = runge_kutta_step(table, Z);
  ARKodeButcherTable_Free(table);
  return step;
}

}  // namespace

MatX linear_step(std::string_view method, const MatX& Z) {
  if (Z.rows() != Z.cols()) fail("the matrix of a linear step is {} x {}, not square", Z.rows(), Z.cols());
  const auto& all = ark_methods();
  const auto ark = std::find_if(all.begin(), all.end(), [&](const ArkMethod& m) { return m.name == method; });
  return ark != all.end() ? runge_kutta_step(*ark, Z)
                          : sun::multirate_step(method, Z, MatX::Zero(Z.rows(), Z.cols()), 1.0);
}

}  // namespace palpate::integrate
