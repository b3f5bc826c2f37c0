#include "integrate/linear_step.h"

#include <Eigen/LU>
#include <algorithm>
#include <vector>

#include "integrate/sundials/butcher_table.h"
#include "integrate/sundials/multirate.h"
#include "palpate/core/error.h"

namespace palpate::integrate {
namespace {

// In extended precision: with entries of |Z| = y the sum over the stages cancels to 1/y of its terms.
using MatL = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// Computes the step stage by stage, as every table here is lower triangular:
///     Y_i = (1 - a_ii Z)^-1 (1 + sum_(j<i) (a_ij Z + a^_ij Z^) Y_j),   R = 1 + sum_i (b_i Z + b^_i Z^) Y_i
/// with Z, a, b of `table` and Z^, a^, b^ of `other`, which is explicit, or null.
MatX runge_kutta_step(const ButcherTable& table, const MatX& Z, const ButcherTable* other = nullptr,
                      const MatX& other_Z = {}) {
  const Eigen::Index n = Z.rows();
  const MatL z = Z.cast<long double>(), other_z = other_Z.cast<long double>(), one = MatL::Identity(n, n);
  const auto add = [](MatL& sum, double by, const MatL& rate) { sum += static_cast<long double>(by) * rate; };
  MatL step = one;
  std::vector<MatL> rates, other_rates;  // Z Y_j, Z^ Y_j
  for (Eigen::Index i = 0; i < table.stages(); ++i) {
    MatL stage = one;
    for (Eigen::Index j = 0; j < i; ++j) {
      add(stage, table.A(i, j), rates[static_cast<std::size_t>(j)]);
      if (other) add(stage, other->A(i, j), other_rates[static_cast<std::size_t>(j)]);
    }
    const auto own = static_cast<long double>(table.A(i, i));
    stage = (one - own * z).eval().partialPivLu().solve(stage).eval();
    rates.push_back(z * stage);
    add(step, table.b[i], rates.back());
    if (!other) continue;
    other_rates.push_back(other_z * stage);
    add(step, other->b[i], other_rates.back());
  }
  return step.cast<double>();
}

const ArkMethod* find_ark(std::string_view name) {
  const auto& all = ark_methods();
  const auto found = std::find_if(all.begin(), all.end(), [&](const ArkMethod& m) { return m.name == name; });
  return found != all.end() ? &*found : nullptr;
}

void check_square(const MatX& Z, Eigen::Index rows) {
  if (Z.rows() != Z.cols() || Z.rows() != rows)
    fail("a matrix of a linear step is {} x {}; it must be {} x {}", Z.rows(), Z.cols(), rows, rows);
}

}  // namespace

MatX linear_step(std::string_view method, const MatX& Z) {
  check_square(Z, Z.rows());
  const ArkMethod* ark = find_ark(method);
  return ark ? runge_kutta_step(leading_table(*ark), Z)
             : sun::multirate_step(method, Z, MatX::Zero(Z.rows(), Z.cols()), 1.0);
}

MatX split_step(std::string_view method, const MatX& Z, const MatX& other) {
  check_square(Z, Z.rows());
  check_square(other, Z.rows());
  const ArkMethod* ark = find_ark(method);
  if (!ark) return sun::multirate_step(method, Z, other, 1.0);
  if (ark->implicit_table < 0 || ark->explicit_table < 0)
    fail("{} is not an additive method and cannot split a system", method);
  const ButcherTable second = explicit_table(*ark);
  return runge_kutta_step(implicit_table(*ark), Z, &second, other);
}

}  // namespace palpate::integrate
