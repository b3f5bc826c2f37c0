#include "contact/facing.h"

#include <cmath>

#include "palpate/core/counters.h"

namespace palpate::contact {

void FacePlanes::start(const Patch& patch) {
  patch_ = &patch;
  planes_.resize(patch.visible.size());
  for (Plane& plane : planes_) plane.state = Plane::kUnknown;
}

// With corners p0, p1, p2 seen along w and d_i = p_i - p0, the weights of corners 1 and 2 at p0 + d are
// (d x d_2) / (d_1 x d_2) and (d_1 x d) / (d_1 x d_2).
void FacePlanes::prepare(Plane& plane, int face) const {
  constexpr double kFlat = 1e-12;
  const auto corner = [&](int k) { return patch_->uvw.col((*patch_->faces)(k, face)); };
  const Vec3 d1 = corner(1) - corner(0), d2 = corner(2) - corner(0);
  const double area = d1.x() * d2.y() - d1.y() * d2.x();
  if (std::abs(area) <= kFlat * (d1.squaredNorm() + d2.squaredNorm())) {
    plane.state = Plane::kEdgeOn;
    return;
  }
  constexpr double kSteep = 5.0;  // slope: 79 degrees
  const Vec3 p0 = corner(0);
  plane = {p0.x(), p0.y(), d2.y() / area, -d2.x() / area, -d1.y() / area, d1.x() / area,
           p0.z(), d1.z(), d2.z(),        Plane::kReady,  false};
  const double along_u = plane.u1 * plane.w1 + plane.u2 * plane.w2,
               along_v = plane.v1 * plane.w1 + plane.v2 * plane.w2;
  plane.wall = along_u * along_u + along_v * along_v > kSteep * kSteep;
}

FacePlanes::Plane& FacePlanes::plane(int visible) {
  Plane& plane = planes_[static_cast<std::size_t>(visible)];
  if (plane.state == Plane::kUnknown) prepare(plane, patch_->visible[static_cast<std::size_t>(visible)]);
  return plane;
}

bool FacePlanes::is_wall(int visible) {
  const Plane& p = plane(visible);
  return p.state == Plane::kEdgeOn || p.wall;
}

bool FacePlanes::at(int visible, double u, double v, Vec3& weights, double& w) {
  constexpr double kOutside = -0.25;
  const Plane& plane = this->plane(visible);
  if (plane.state == Plane::kEdgeOn) return false;
  const double du = u - plane.u0, dv = v - plane.v0;
  const double first = plane.u1 * du + plane.v1 * dv, second = plane.u2 * du + plane.v2 * dv;
  weights = Vec3(1.0 - first - second, first, second);
  w = plane.w0 + first * plane.w1 + second * plane.w2;
  return weights.minCoeff() >= kOutside;
}

bool facing_at(const FacePair& pair, FacePlanes& a, FacePlanes& b, Facing& out) {
  if (a.at(static_cast<int>(pair.a), out.u, out.v, out.weights_a, out.w_a) &&
      b.at(static_cast<int>(pair.b), out.u, out.v, out.weights_b, out.w_b))
    return true;
  counters::count("contact.edge_on");
  return false;
}

}  // namespace palpate::contact
