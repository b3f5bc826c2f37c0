#include "proxy/apart.h"

#include <algorithm>

namespace palpate::proxy {
namespace {

constexpr int kSteps = 12;

/// Returns the least u . (x - y) over both hulls.
double least_along(const ProxySet& a, int p, const ProxySet& b, int q, const Vec3& u) {
  return -a.most_along(p, -u) - b.most_along(q, u);
}

/// Returns the shortest vector on the segment from v to s.
Vec3 shorten(const Vec3& v, const Vec3& s) {
  const Vec3 step = s - v;
  const double length2 = step.squaredNorm();
  return length2 > 0.0 ? Vec3(v + std::clamp(-v.dot(step) / length2, 0.0, 1.0) * step) : v;
}

}  // namespace

bool apart(const ProxySet& a, int p, const ProxySet& b, int q, double inexact, const Reach& reach,
           Vec3& direction, bool& by_memory) {
  const auto proves = [&](const Vec3& u) { return least_along(a, p, b, q, u) > inexact + reach.along(u); };
  by_memory = !direction.isZero() && proves(direction);  // kept as a unit vector
  if (by_memory) return true;
  const double margin = inexact + reach.without_drift();
  Vec3 v = a.centre(p) - b.centre(q);
  for (int i = 0; i < kSteps; ++i) {
    const double length = v.norm();
    if (!(length > margin)) break;
    direction = v / length;
    if (proves(direction)) return true;
    Vec3 farthest = a.support(p, -v) - b.support(q, v);
    if (v.dot(reach.drift) < 0.0) farthest += reach.drift;
    v = shorten(v, farthest);
  }
  return false;
}

}  // namespace palpate::proxy
