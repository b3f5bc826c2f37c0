#pragma once
#include <Eigen/Core>

namespace palpate {

/// Whether every entry is finite: 0 x is NaN where x is infinite or NaN.  Computed as a sum, which the
/// compiler vectorises; Eigen's allFinite() tests entry by entry.
template <class Derived>
bool all_finite(const Eigen::DenseBase<Derived>& values) {
  return (0.0 * values.derived()).sum() == 0.0;
}

}  // namespace palpate
