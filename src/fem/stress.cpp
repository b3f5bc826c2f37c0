#include "stress.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace palpate::fem {
/// sqrt(3/2 dev : dev), dev the deviator of the Cauchy stress
double von_mises(const Mat3& P, const Mat3& F) {
  const Mat3 cauchy = P * F.transpose() / std::max(F.determinant(), kSmallestStressDet);
  const Mat3 deviator = cauchy - cauchy.trace() / 3.0 * Mat3::Identity();
  return std::sqrt(1.5 * deviator.squaredNorm());
}

}  // namespace palpate::fem
