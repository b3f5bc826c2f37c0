#include "experiments/compare/grid_convergence.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"

namespace palpate::compare {
namespace {

/// Relative difference below which two runs on different meshes are the same: a few hundred roundings.
constexpr double kSame = 1e-13;
/// Limits of the order in the factor of a sequence outside the asymptotic range, and for its search.
constexpr double kLowOrder = 0.5, kFormalOrder = 2.0, kMostOrder = 20.0;
/// Orders below it are no convergence.
constexpr double kNoOrder = 0.05;

/// Ratio (f3 - f2)/(f2 - f1) of an error of order p; ascending in p, and log r32/log r21 for p -> 0.
double ratio_at(double p, double r21, double r32) {
  return std::pow(r21, p) * std::expm1(p * std::log(r32)) / std::expm1(p * std::log(r21));
}

/// Returns the order of that ratio by bisection; kMostOrder where it is larger.
double order_of(double ratio, double r21, double r32) {
  double low = 1e-6, high = kMostOrder;
  if (ratio_at(high, r21, r32) < ratio) return high;
  while (high - low > 1e-10) {
    const double p = 0.5 * (low + high);
    (ratio_at(p, r21, r32) < ratio ? low : high) = p;
  }
  return 0.5 * (low + high);
}

/// Values and sizes of the finest levels: f1, f2, and the ratio of their sizes.
struct Finest {
  double f1, f2, r21;

  double correction(double order) const { return (f1 - f2) / (std::pow(r21, order) - 1.0); }
  GridEstimate at(Convergence kind, double order, double observed, double safety) const {
    return {kind, observed, f1 + correction(order), safety * std::abs(correction(order))};
  }
};

/// An estimate without extrapolation: the value of the finest mesh, and three times the largest difference of
/// two levels as uncertainty (Eca and Hoekstra 2014).
GridEstimate without_order(Convergence kind, const Finest& finest, double largest_difference) {
  return {kind, std::numeric_limits<double>::quiet_NaN(), finest.f1, kCautiousSafety * largest_difference};
}

}  // namespace

std::string to_string(Convergence kind) {
  switch (kind) {
    case Convergence::kAsymptotic: return "asymptotic";
    case Convergence::kMonotone: return "not in the asymptotic range";
    case Convergence::kOscillating: return "oscillates: no order";
    case Convergence::kDiverging: return "does not converge: no order";
    case Convergence::kTwoLevels: return "two levels, order assumed";
    case Convergence::kEqual: return "levels are equal: refinement has no effect";
    case Convergence::kTooFew: break;
  }
  return "one level: no estimate";
}

GridEstimate estimate(const std::vector<double>& sizes, const std::vector<double>& values) {
  PALPATE_CHECK(sizes.size() == values.size(), "{} sizes of {} values", sizes.size(), values.size());
  const std::size_t n = values.size();
  GridEstimate out;
  if (n < 2) return out;
  const Finest finest{values[n - 1], values[n - 2], sizes[n - 2] / sizes[n - 1]};
  const double e21 = finest.f2 - finest.f1;
  const double scale = std::max(std::abs(finest.f1), std::abs(finest.f2));
  if (std::abs(e21) <= kSame * scale || !(finest.r21 > 1.0)) {
    out.kind = Convergence::kEqual;
    out.value = finest.f1;
    return out;
  }
  if (n == 2) return finest.at(Convergence::kTwoLevels, kAssumedOrder, out.order, kCautiousSafety);
  const double e32 = values[n - 3] - finest.f2, r32 = sizes[n - 3] / sizes[n - 2];
  const double largest = std::max({std::abs(e21), std::abs(e32), std::abs(e21 + e32)});
  if (std::abs(e32) <= kSame * scale || !(r32 > 1.0))
    return without_order(Convergence::kDiverging, finest, largest);
  const double ratio = e32 / e21;
  if (ratio < 0.0) return without_order(Convergence::kOscillating, finest, largest);
  if (ratio <= std::log(r32) / std::log(finest.r21))
    return without_order(Convergence::kDiverging, finest, largest);
  const double order = order_of(ratio, finest.r21, r32);
  if (order < kNoOrder) return without_order(Convergence::kDiverging, finest, largest);
  if (order >= kLeastOrder && order <= kLargestOrder)
    return finest.at(Convergence::kAsymptotic, std::min(order, kFormalOrder), order, kSafety);
  return finest.at(Convergence::kMonotone, std::clamp(order, kLowOrder, kFormalOrder), order,
                   kCautiousSafety);
}

}  // namespace palpate::compare
