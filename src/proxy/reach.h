#pragma once
#include <algorithm>
#include <cmath>

#include "palpate/core/types.h"

namespace palpate::proxy {

/// Bound on the velocities of a proxy's skin and tetrahedra: each point's lies within `spread` of `velocity`
/// [m/s].
struct ProxyMotion {
  Vec3 velocity = Vec3::Zero();
  double spread = 0.0;
};

/// Bound on how near a body comes to another within a time T.  A point x of it and a point y of the other
/// have the relative velocity w + r, where w is the difference of their proxies' velocities and |r| <= s, the
/// sum of their spreads.  Along a unit direction u, from the other body to this one, after t <= T
///
///   u.(x - y)(t)  >=  u.(x - y)(0) + min(0, T (u.w - s)),
///
/// and points farther apart along u than `along(u)` = max(gap, T (s - u.w)) are neither within the gap now
/// nor touch until then.  Velocities are taken as constant: accelerating points may come nearer.
struct Reach {
  double gap = 0.0;           ///< distance that counts as near without any motion [m]
  Vec3 drift = Vec3::Zero();  ///< T w [m]; zero where the gap is more than motion can close
  double spread = 0.0;        ///< T s [m]; zero where the gap is more than motion can close

  Reach() = default;
  explicit Reach(double gap_) : gap(gap_) {}
  /// @param time  T [s]; negative: backwards along displacements
  /// @param own, other  motion of this body's proxy and of the other's
  Reach(double gap_, double time, const ProxyMotion& own, const ProxyMotion& other) : gap(gap_) {
    const Vec3 way = time * (own.velocity - other.velocity);
    const double wider = std::abs(time) * (own.spread + other.spread);
    if (wider + way.norm() <= gap) return;
    drift = way;
    spread = wider;
  }
  double along(const Vec3& u) const { return std::max(gap, spread - u.dot(drift)); }
  /// Bound of `along` for directions with u.w >= 0 (the bodies drift apart).
  double without_drift() const { return std::max(gap, spread); }
  /// Upper bound of `along` over all directions.
  double in_any_direction() const { return std::max(gap, spread + drift.norm()); }
  bool is_moving() const { return !drift.isZero(0.0); }
  /// Returns the reach of the other body relative to this one.
  Reach from_other() const {
    Reach out = *this;
    out.drift = -drift;
    return out;
  }
};

}  // namespace palpate::proxy
