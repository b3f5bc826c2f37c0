// Regularised friction alone, -L v/max(|v|, v_r), is a damper below v_r: a sticking contact creeps, at v_r
// times the fraction of L that it has to hold. A spring in parallel to the damper prevents this. With u the
// deflection since the points came into contact, and tau the spring's retardation time, damping over
// stiffness, friction is
//
//     -L w/max(|w|, v_r),   w = v + u/tau,   |u| <= tau v_r:
//
// a Kelvin-Voigt element within the cone (Coulomb's law with bristles: Dahl 1968; Haessig, Friedland 1991).
// At rest u = tau v_r times that fraction, 1e-6 m for v_r = 2e-4 m/s and tau = 5 ms, and nothing moves. Where
// the points slide the anchor is dragged along, so that |u| never exceeds tau v_r, and w has the direction of
// v up to v_r/|v|.
//
// Between two queries u is a function of the state: the tangential part of the relative displacement of the
// two material points of the last query, added to the deflection at the query and cut to its maximum length
// at every evaluation. A query moves the anchors to the new points, with the present deflections, and changes
// no force. The motion of the anchor between two queries is neglected: where points slide one way, stop and
// reverse within one period, friction lags by up to L over the distance that they had slid.
//
// Deflections rotate with the carrier of the second point: with the axes of its frame, or of the triangle of
// its nodes.
//
// A step of one linear solve holds u constant for its length h. The spring is slower than the damper by tau:
// u is multiplied by no less than 1 - h/tau, so that tau, the time between two queries, is never too short.
#include "contact/friction_anchors.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"

namespace palpate::contact {
namespace {

/// Returns axes that move with the carrier of a point.
Mat3 axes_of(const SurfacePoint& point, const dynamics::StateView& state,
             const std::vector<FrameState>& frames) {
  if (point.frame >= 0) return frames[static_cast<std::size_t>(point.frame)].R;
  if (point.count < 3) return Mat3::Identity();
  const Vec3 origin = state.position(point.node[0]);
  const Vec3 first = state.position(point.node[1]) - origin, second = state.position(point.node[2]) - origin;
  const Vec3 across = first.cross(second);
  const double size = across.norm();
  if (!(size > 0.0)) return Mat3::Identity();
  Mat3 axes;
  axes.col(0) = first.normalized();
  axes.col(2) = across / size;
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

Vec3 tangential(const Vec3& x, const Vec3& normal) { return x - normal.dot(x) * normal; }

}  // namespace

FrictionAnchors::Carried FrictionAnchors::carried(const SurfacePoint& point, const dynamics::StateView& state,
                                                  const std::vector<FrameState>& frames) {
  Carried out{point, Vec3::Zero()};
  const Vec3 beside = point.frame >= 0 ? point_motion(point, state, frames).arm : point.offset;
  out.local = axes_of(point, state, frames).transpose() * beside;
  return out;
}

Vec3 FrictionAnchors::shortened(const Vec3& u) const {
  const double length = u.norm();
  return length > longest_ ? Vec3(longest_ / length * u) : u;
}

Vec3 FrictionAnchors::deflection(const Anchor& anchor, const Vec3& normal, const dynamics::StateView& state,
                                 const std::vector<FrameState>& frames) const {
  const auto place = [&](const Carried& carried, const Mat3& axes) {
    Vec3 x = axes * carried.local;
    if (carried.point.frame >= 0)
      return Vec3(x + frames[static_cast<std::size_t>(carried.point.frame)].pose.translation);
    for (std::size_t k = 0; k < static_cast<std::size_t>(carried.point.count); ++k)
      x += carried.point.weight[k] * state.position(carried.point.node[k]);
    return x;
  };
  const Mat3 of_b = axes_of(anchor.b.point, state, frames);
  const Vec3 way = place(anchor.a, axes_of(anchor.a.point, state, frames)) - place(anchor.b, of_b);
  return shortened(tangential(of_b * anchor.deflection + way, normal));
}

void FrictionAnchors::renew(std::span<ContactSample> samples, std::span<const int> points,
                            const dynamics::StateView& state, const std::vector<FrameState>& frames) {
  std::swap(anchors_, before_);
  anchors_.clear();
  if (samples.size() != points.size()) return;  // The samples represent no material points: no anchors.
  auto last = before_.begin();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ContactSample& s = samples[i];
    while (last != before_.end() && last->point < points[i]) ++last;
    Vec3 u = Vec3::Zero();
    if (s.gap < 0.0 && last != before_.end() && last->point == points[i])
      u = last->is_fresh ? deflection(*last, s.normal, state, frames) : last->deflection_at_query;
    anchors_.push_back({points[i], true, carried(s.a, state, frames), carried(s.b, state, frames),
                        axes_of(s.b, state, frames).transpose() * u, u});
    s.deflection_rate = u / tau_;
  }
}

void FrictionAnchors::follow(std::span<ContactSample> samples, const dynamics::StateView& state,
                             const std::vector<FrameState>& frames) const {
  if (anchors_.empty()) return;
  PALPATE_CHECK(samples.size() == anchors_.size(),
                "friction: {} samples passed to follow(), but {} have anchors", samples.size(),
                anchors_.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i].deflection_rate = samples[i].gap < 0.0 && samples[i].area > 0.0
                                     ? Vec3(deflection(anchors_[i], samples[i].normal, state, frames) / tau_)
                                     : Vec3::Zero();
}

void FrictionAnchors::archive(Archive& a) {
  std::vector<Anchor> deflected;
  for (const Anchor& anchor : anchors_)
    if (!anchor.deflection_at_query.isZero(0.0)) deflected.push_back(anchor);
  std::size_t count = deflected.size();
  a("anchors", count);
  deflected.resize(count);
  a.rows("anchor", deflected, [](const auto& visit, Anchor& anchor) {
    visit(anchor.point);
    visit(anchor.deflection_at_query);
  });
  if (!a.is_restoring()) return;
  for (Anchor& anchor : deflected) anchor.is_fresh = false;
  anchors_ = std::move(deflected);
}

}  // namespace palpate::contact
