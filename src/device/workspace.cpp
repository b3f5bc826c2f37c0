#include "palpate/device/workspace.h"

#include <algorithm>

namespace palpate::device {

double Workspace::distance_outside(const Vec3& p) const {
  const Vec3 d = p - center;
  double out = radius > 0.0 ? std::max(0.0, d.norm() - radius) : 0.0;
  if (!size.isZero(0.0)) out = std::max(out, (d.cwiseAbs() - 0.5 * size).cwiseMax(0.0).norm());
  return out;
}

double Workspace::share(const Vec3& p) const {
  if (!is_bounded()) return 1.0;
  if (!p.allFinite()) return 0.0;
  const double x = std::min(distance_outside(p) / margin, 1.0);
  return 1.0 - x * x * (3.0 - 2.0 * x);
}

}  // namespace palpate::device
