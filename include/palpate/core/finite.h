#pragma once
#include <Eigen/Core>

namespace palpate {

/// Whether every entry is a number: 0 x is none where x is infinite or none.  A sum that the compiler takes
/// several entries at a time, where Eigen's allFinite() asks one by one.
template <class Derived>
bool all_finite(const Eigen::DenseBase<Derived>& values) {
  return (0.0 * values.derived()).sum() == 0.0;
}

}  // namespace palpate
