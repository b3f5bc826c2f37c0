#include "palpate/dynamics/point_stiffness.h"

namespace palpate::dynamics {

void PointStiffness::add_product(const VecX& x, double by, VecX& y) const {
  for (const OfPoint& point : points) {
    const int count = point.nodes.count;
    const auto row = [&](int i) { return 3 * point.nodes.node[static_cast<std::size_t>(i)]; };
    const Vec3 origin = point.nodes.relative ? Vec3(x.segment<3>(row(0))) : Vec3::Zero();
    Vec3 motion = Vec3::Zero();
    for (int i = 0; i < count; ++i) motion += point.weight[i] * (x.segment<3>(row(i)) - origin);
    const Vec3 force = by * (point.C * motion);
    for (int i = 0; i < count; ++i) y.segment<3>(row(i)) += point.weight[i] * force;
  }
}

}  // namespace palpate::dynamics
