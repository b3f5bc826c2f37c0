#include "integrate/error_test.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "integrate/sundials/ark_calibration.h"
#include "integrate/tuning.h"

namespace palpate::integrate {
namespace {

constexpr int kHighestBdf = 5;

/// Returns the power of rtol in the tolerance of the test, (m+1)/p.
double bdf_power(const IntegratorSpec& spec) {
  const double k = spec.max_order > 0 ? spec.max_order : kHighestBdf;
  return (k + 1.0) / k;
}
const ArkCalibration& calibration(const IntegratorSpec& spec) {
  return ark_calibration(ark_method(spec.name));
}

/// Returns the rtol at which the test has its tightest tolerance, rounded up to two digits. Where T is above
/// rtol, the solution is more accurate than the test, and rounding limits the solution first.
double tightest(double power, double factor = 1.0, double other = 0.0) {
  const double by_test = std::pow(tuning::kTightestErrorTest / factor, 1.0 / power),
               exact = std::max({by_test, tuning::kTightestErrorTest, other}),
               scale = std::pow(10.0, 1.0 - std::floor(std::log10(exact) + 1e-9));
  return std::ceil(exact * scale * (1.0 - 1e-9)) / scale;
}

/// Returns the rtol at which rounding errors amount to a third of it. A step h causes 1/h roundings of the
/// motion per radian, and c a h^p = rtol.
double rounding_of(const ArkCalibration& c) {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon() / 2.0;
  const double by_step = std::pow(c.error * kUsualMotion, 1.0 / c.order);
  return std::pow(tuning::kDefects * kEpsilon * kUsualMotion * by_step, c.order / (c.order + 1.0));
}

}  // namespace

double error_test_rtol_of_bdf(const IntegratorSpec& spec) { return std::pow(spec.rtol, bdf_power(spec)); }
double error_test_rtol_of_adams(const IntegratorSpec& spec) { return tuning::kAdamsShare * spec.rtol; }
double error_test_rtol_of_ark(const IntegratorSpec& spec) {
  return calibration(spec).factor * std::pow(spec.rtol, calibration(spec).power);
}
double error_test_rtol_of_mri(const IntegratorSpec& spec) { return tuning::kFastShare * spec.rtol; }

double tightest_rtol_of_bdf(const IntegratorSpec& spec) { return tightest(bdf_power(spec)); }
double tightest_rtol_of_adams(const IntegratorSpec&) { return tightest(1.0, tuning::kAdamsShare); }
double tightest_rtol_of_ark(const IntegratorSpec& spec) {
  const ArkCalibration& c = calibration(spec);
  return tightest(c.power, c.factor, std::max(tuning::kDefects * c.defect * kUsualMotion, rounding_of(c)));
}
double tightest_rtol_of_mri(const IntegratorSpec&) { return tuning::kTightestErrorTest / tuning::kFastShare; }

Range rtol_range(double tightest) {
  return Range::closed(tightest, IntegratorRanges::rtol.high,
                       "1e-3 is usual; below the lower limit rounding dominates");
}

}  // namespace palpate::integrate
