#include "integrate/sundials/ark_calibration.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "integrate/sundials/butcher_table.h"
#include "palpate/core/error.h"

// On y' = lambda y a step multiplies by R(z) = 1 + sum_k z^k b^T A^(k-1) 1, where e^z has z^k/k!, and the
// estimate is sum_k z^k (b - b^)^T A^(k-1) 1. Let c be the first coefficient in which R and e^z differ, at
// z^(p+1), and d the first one of the estimate, at z^(m+1). The error of a motion of amplitude a (in units of
// its tolerance at rtol = 1), over a radian, is
//     c a h^p,    d a h^(m+1) = T    =>    c a (T/(d a))^(p/(m+1)).
// Requiring this error to be rtol yields
//     T = d a (rtol/(c a))^((m+1)/p) = factor rtol^power.
// For the usual m = p - 1 this is d/c rtol, whatever the amplitude. Without the factor the errors of pairs
// differ by a factor of a hundred: in ARK5(4)8L[2]SA d is nearly zero by design, and the test detects a small
// part of the error.
//
// The factor is at most 1: where a force has a kink the estimate does not depend on d/c of smooth motion.
// Loosened by d/c, SDIRK 5(3)4 let a ball on an undamped spring gain 4.5e-6 of its energy at rtol 1e-10, and
// 2.2e-6 at 1e-11.
//
// Three pairs have m = p on linear motion and p - 1 on others. The power is half-way between (error_test.h),
// and the factor is chosen so that both agree at kMiddle.
//
// Two tables of Cash are given to eleven digits: sum b is 1 + 8e-12, and the error of a motion per radian is
// that share of its amplitude, or more, however short the step.

namespace palpate::integrate {
namespace {

constexpr double kMiddle = 1e-6;     // Middle of the usual tolerances.
constexpr double kRounding = 1e-14;  // Coefficients of a table below this are zero.

ArkCalibration calibrate(const ArkMethod& method) {
  const ButcherTable table = leading_table(method);
  const int p = method.traits.order, embedded = std::min(p, method.embedded_order);
  const VecX difference = table.b - table.embedded;
  VecX stage = VecX::Ones(table.stages());

  ArkCalibration out;
  double c = 0.0, d = 0.0, factorial = 1.0;
  const int m = embedded + (method.sharper_on_linear_motion ? 1 : 0);
  for (int k = 1; k <= p + 1; ++k) {
    factorial *= k;
    const double error = std::abs(table.b.dot(stage) - 1.0 / factorial);
    if (k <= p)
      out.defect = std::max(out.defect, error);
    else
      c = error;
    if (k == m + 1) d = std::abs(difference.dot(stage));
    stage = table.A * stage;
  }
  if (out.defect < kRounding) out.defect = 0.0;
  out.order = p;
  out.error = c;
  PALPATE_CHECK(c > kRounding && d > kRounding, "{}: the error on linear motion is zero", method.name);

  out.power = (embedded + (method.sharper_on_linear_motion ? 0.5 : 0.0) + 1.0) / p;
  const double a = kUsualMotion, T = d * a * std::pow(kMiddle / (c * a), (m + 1.0) / p);
  const double smooth = T / std::pow(kMiddle, out.power);
  out.factor = std::min(1.0, smooth);
  out.spare = std::max(1.0, smooth);
  return out;
}

}  // namespace

const ArkCalibration& ark_calibration(const ArkMethod& method) {
  static const std::map<std::string, ArkCalibration> all = [] {
    std::map<std::string, ArkCalibration> map;
    for (const ArkMethod& one : ark_methods()) map.emplace(one.name, calibrate(one));
    return map;
  }();
  return all.at(method.name);
}

}  // namespace palpate::integrate
