#include "stress.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "palpate/core/polar.h"

namespace palpate::fem {
namespace {

constexpr double kSmallestDet = 0.1;

}  // namespace

/// sqrt(3/2 dev : dev) of P F^T / J.  P F^T = R T S R^T with T = 2 mu (S - I) + (lambda tr(S - I) + p) I: the
/// norm needs no rotation.
double von_mises(const Mat3& F, const Lame& lame, double tension) {
  const Mat3 S = polar_decomposition(F).S;
  const Mat3 strain = S - Mat3::Identity();
  const Mat3 cauchy = (2.0 * lame.mu * strain + (lame.lambda * strain.trace() + tension) * Mat3::Identity()) *
                      S / std::max(F.determinant(), kSmallestDet);
  const Mat3 deviator = cauchy - cauchy.trace() / 3.0 * Mat3::Identity();
  return std::sqrt(1.5 * deviator.squaredNorm());
}

VecX nodal_von_mises(const ElementChunks& elements, const double* x,
                     const std::vector<ElementModel>& models) {
  VecX out = VecX::Zero(elements.node_count());
  elements.for_each([&](const ElementChunks::Element& e) {
    const ElementModel& model = models[static_cast<std::size_t>(e.material)];
    const double share = 0.25 * e.volume * von_mises(e.edges(x) * e.gradients, {model.mu, model.lambda});
    for (int node : e.node) out[node] += share;
  });
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const double volume = elements.nodal_volume[static_cast<std::size_t>(i)];
    if (volume > 0.0) out[i] /= volume;
  }
  return out;
}

}  // namespace palpate::fem
