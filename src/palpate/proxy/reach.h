#pragma once
#include <algorithm>
#include <cmath>

#include "palpate/core/types.h"

namespace palpate::proxy {

/// Velocities of what a proxy stands for: each point's lies within `spread` of `velocity` [m/s].
struct ProxyMotion {
  Vec3 velocity = Vec3::Zero();
  double spread = 0.0;
};

/// How near a body comes to another within a time T.  A point x of it and a point y of the other have the
/// relative velocity w + r with w the difference of their proxies' velocities and |r| <= the sum of their
/// spreads s.  So along a unit direction u, from the other body to this one, after t <= T
///
///   u.(x - y)(t)  >=  u.(x - y)(0) + min(0, T (u.w - s)),
///
/// and what is farther apart along u than `along(u)` = max(gap, T (s - u.w)) neither is within the gap now
/// nor touches until then.  Present velocities: what accelerates may come nearer.
struct Reach {
  double gap = 0.0;           ///< what counts as near without any motion [m]
  Vec3 drift = Vec3::Zero();  ///< T w [m]; zero where the gap is more than motion can close
  double spread = 0.0;        ///< T s [m]; likewise

  Reach() = default;
  explicit Reach(double gap_) : gap(gap_) {}
  Reach(double gap_, double time, const ProxyMotion& own, const ProxyMotion& other) : gap(gap_) {
    const Vec3 way = time * (own.velocity - other.velocity);
    const double wider = std::abs(time) * (own.spread + other.spread);
    if (wider + way.norm() <= gap) return;
    drift = way;
    spread = wider;
  }
  double along(const Vec3& u) const { return std::max(gap, spread - u.dot(drift)); }
  double without_drift() const { return std::max(gap, spread); }
  double in_any_direction() const { return std::max(gap, spread + drift.norm()); }
  bool is_moving() const { return !drift.isZero(0.0); }
  /// That of the other body against this one.
  Reach from_other() const {
    Reach out = *this;
    out.drift = -drift;
    return out;
  }
};

}  // namespace palpate::proxy
