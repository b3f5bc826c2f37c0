#include "contact/triangle_pair_gap.h"

#include <cmath>

namespace palpate::contact {

void FacePlanes::start(const Patch& patch) {
  patch_ = &patch;
  if (planes_.size() < patch.visible.size()) planes_.resize(patch.visible.size());
  kinds_.assign(patch.visible.size(), Kind::kUnknown);
}

// With corners p0, p1, p2 seen along w and d_i = p_i - p0, the weights of corners 1 and 2 at p0 + d are (d x
// d_2) / (d_1 x d_2) and (d_1 x d) / (d_1 x d_2).
FacePlanes::Kind FacePlanes::prepare(Plane& plane, int face) const {
  constexpr double kFlat = 1e-12;
  const auto corner = [&](int k) { return patch_->uvw.col((*patch_->faces)(k, face)); };
  const Vec3 d1 = corner(1) - corner(0), d2 = corner(2) - corner(0);
  const double area = d1.x() * d2.y() - d1.y() * d2.x();
  if (std::abs(area) <= kFlat * (d1.squaredNorm() + d2.squaredNorm())) return Kind::kEdgeOn;
  const Vec3 p0 = corner(0);
  plane = {p0.x(),        p0.y(), d2.y() / area, -d2.x() / area, -d1.y() / area,
           d1.x() / area, p0.z(), d1.z(),        d2.z()};
  return Kind::kPlain;
}

bool FacePlanes::at(int visible, double u, double v, Vec3& weights, double& w) {
  constexpr double kOutside = -0.25;
  const auto index = static_cast<std::size_t>(visible);
  if (kinds_[index] == Kind::kUnknown) kinds_[index] = prepare(planes_[index], patch_->visible[index]);
  if (kinds_[index] == Kind::kEdgeOn) return false;
  const Plane& plane = planes_[index];
  const double du = u - plane.u0, dv = v - plane.v0;
  const double first = plane.u1 * du + plane.v1 * dv, second = plane.u2 * du + plane.v2 * dv;
  weights = Vec3(1.0 - first - second, first, second);
  w = plane.w0 + first * plane.w1 + second * plane.w2;
  return weights.minCoeff() >= kOutside;
}

}  // namespace palpate::contact
