#include "stress.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace palpate::fem {
namespace {

constexpr double kSmallestDet = 0.1;

}  // namespace

/// sqrt(3/2 dev : dev), dev the deviator of the Cauchy stress
double von_mises(const Mat3& P, const Mat3& F) {
  const Mat3 cauchy = P * F.transpose() / std::max(F.determinant(), kSmallestDet);
  const Mat3 deviator = cauchy - cauchy.trace() / 3.0 * Mat3::Identity();
  return std::sqrt(1.5 * deviator.squaredNorm());
}

VecX nodal_von_mises(const ElementChunks& elements, const double* x, const Law& law,
                     const std::vector<ElementModel>& models) {
  VecX out = VecX::Zero(elements.node_count());
  elements.for_each([&](const ElementChunks::Element& e) {
    const ElementModel& model = models[static_cast<std::size_t>(e.material)];
    const Mat3 F = e.edges(x) * e.gradients;
    const double share = 0.25 * e.volume * von_mises(law.stress(F, {model.mu, model.lambda}), F);
    for (int node : e.node) out[node] += share;
  });
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const double volume = elements.nodal_volume[static_cast<std::size_t>(i)];
    if (volume > 0.0) out[i] /= volume;
  }
  return out;
}

}  // namespace palpate::fem
