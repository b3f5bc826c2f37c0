#include "distance/linear_gap.h"

#include <algorithm>

namespace palpate::distance {
namespace {

// Integrates over a whole triangle of area 1: integral of l_i l_j = (1 + delta_ij)/12.
HatIntegrals over_all(const Vec3& o) {
  return {((o.array() + o.sum()) / 12.0).matrix(), Vec3::Constant(1.0 / 3.0)};
}

// Integrates where o is positive at corner i alone. The positive part is the sub-triangle between corner i
// and the zeros of o on its edges, at fractions s and t of the way to the other corners j and k; its area is
// s t. With the hats m of the sub-triangle, where o has the corner values (o_i, 0, 0), the mean of o m is
// o_i/12 (2, 1, 1), and the hats of the whole triangle are l_j = s m_1, l_k = t m_2,
// l_i = m_0 + (1 - s) m_1 + (1 - t) m_2.
HatIntegrals around_corner(const Vec3& o, int i) {
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  const double s = o[i] / (o[i] - o[j]), t = o[i] / (o[i] - o[k]), area = s * t;
  HatIntegrals out;
  out.overlap[j] = area * o[i] * s / 12.0;
  out.overlap[k] = area * o[i] * t / 12.0;
  out.overlap[i] = area * o[i] * (4.0 - s - t) / 12.0;
  out.area[j] = area * s / 3.0;
  out.area[k] = area * t / 3.0;
  out.area[i] = area * (3.0 - s - t) / 3.0;
  return out;
}

}  // namespace

HatIntegrals integrate_hats(const Vec3& o) {
  const auto positive = (o.array() > 0.0).eval();
  switch (positive.count()) {
    case 0: return {};
    case 1: return around_corner(o, positive[0] ? 0 : positive[1] ? 1 : 2);
    case 2: {  // o = o+ - (-o)+
      const HatIntegrals all = over_all(o), rest = around_corner(-o, !positive[0] ? 0 : !positive[1] ? 1 : 2);
      return {(all.overlap + rest.overlap).cwiseMax(0.0), (all.area - rest.area).cwiseMax(0.0)};
    }
    default: return over_all(o);
  }
}

// A quadratic function with Hessian H is below its linear interpolation by 1/24 sum over the edges e of e.H e
// in the mean, and H e is the change of the gradient along e. The same formula applied to |n|^2 = 1 shows
// that the interpolated n has a mean square of 1 - 1/12 sum |H e|^2.
Missed missed_by_linear(const Mat3& x, const Mat3& normal) {
  Missed out{0.0, 0.0};
  for (int i = 0; i < 3; ++i) {
    const Vec3 turn = normal.col((i + 1) % 3) - normal.col(i);
    out.gap += turn.dot(x.col((i + 1) % 3) - x.col(i)) / 24.0;
    out.normal += turn.squaredNorm() / 24.0;
  }
  return out;
}

}  // namespace palpate::distance
