#include "proxy/lanes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::proxy {
namespace {

// GCC's vectors become whatever registers the function's target has.  Sums are formed lane by lane; with fused multiply-add their last bits differ
// between targets, which moves a bound by rounding and no force.
typedef double Pack __attribute__((vector_size(8 * kLanes)));
typedef double PackInMemory __attribute__((vector_size(8 * kLanes), may_alias, aligned(8)));
typedef long long Mask __attribute__((vector_size(8 * kLanes)));

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define PALPATE_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define PALPATE_CLONES
#endif
#define PALPATE_LOAD(pointer) (*reinterpret_cast<const PackInMemory*>(pointer))
#define PALPATE_STORE(pointer, value) (*reinterpret_cast<PackInMemory*>(pointer) = (value))

[[gnu::always_inline]] inline int farthest_inline(Columns p, int count, const double d[3]) {
  Pack most = Pack{} - std::numeric_limits<double>::infinity();
  Mask where = {}, here = {};
  for (int lane = 0; lane < kLanes; ++lane) here[lane] = lane;
  for (int i = 0; i < count; i += kLanes, here += kLanes) {
    const Pack along = d[0] * PALPATE_LOAD(p.x + i) + d[1] * PALPATE_LOAD(p.y + i) + d[2] * PALPATE_LOAD(p.z + i);
    const Mask more = along > most;
    most = more ? along : most;
    where = more ? here : where;
  }
  int best = 0;
  for (int lane = 1; lane < kLanes; ++lane)
    if (most[lane] > most[best] || (most[lane] == most[best] && where[lane] < where[best])) best = lane;
  return static_cast<int>(where[best]);
}

[[gnu::always_inline]] inline double most_along_inline(Columns p, int count, const double d[3]) {
  Pack most = Pack{} - std::numeric_limits<double>::infinity();
  for (int i = 0; i < count; i += kLanes) {
    const Pack along = d[0] * PALPATE_LOAD(p.x + i) + d[1] * PALPATE_LOAD(p.y + i) + d[2] * PALPATE_LOAD(p.z + i);
    most = along > most ? along : most;
  }
  const auto greater = [](double a, double b) { return a > b ? a : b; };
  return greater(greater(greater(most[0], most[1]), greater(most[2], most[3])), greater(greater(most[4], most[5]), greater(most[6], most[7])));
}

}  // namespace

PALPATE_CLONES void moments(Columns p, Columns q, int count, double sums[12]) {
  Pack sum[12] = {};
  for (int i = 0; i < count; i += kLanes) {
    const Pack px = PALPATE_LOAD(p.x + i), py = PALPATE_LOAD(p.y + i), pz = PALPATE_LOAD(p.z + i);
    const Pack qx = PALPATE_LOAD(q.x + i), qy = PALPATE_LOAD(q.y + i), qz = PALPATE_LOAD(q.z + i);
    sum[0] += px;
    sum[1] += py;
    sum[2] += pz;
    sum[3] += px * qx;
    sum[4] += px * qy;
    sum[5] += px * qz;
    sum[6] += py * qx;
    sum[7] += py * qy;
    sum[8] += py * qz;
    sum[9] += pz * qx;
    sum[10] += pz * qy;
    sum[11] += pz * qz;
  }
  for (int k = 0; k < 12; ++k) {
    sums[k] = 0.0;
    for (int lane = 0; lane < kLanes; ++lane) sums[k] += sum[k][lane];
  }
}

PALPATE_CLONES double residuals(Columns p, Columns rest, int count, const double a[9], const double o[3], double* squares) {
  Pack most = {}, total = {};
  for (int i = 0; i < count; i += kLanes) {
    const Pack x = PALPATE_LOAD(rest.x + i), y = PALPATE_LOAD(rest.y + i), z = PALPATE_LOAD(rest.z + i);
    const Pack dx = PALPATE_LOAD(p.x + i) - (o[0] + a[0] * x + a[1] * y + a[2] * z);
    const Pack dy = PALPATE_LOAD(p.y + i) - (o[1] + a[3] * x + a[4] * y + a[5] * z);
    const Pack dz = PALPATE_LOAD(p.z + i) - (o[2] + a[6] * x + a[7] * y + a[8] * z);
    const Pack square = dx * dx + dy * dy + dz * dz;
    PALPATE_STORE(squares + i, square);
    most = most < square ? square : most;
    total += square;
  }
  double out = 0.0, sum = 0.0;
  for (int lane = 0; lane < kLanes; ++lane) {
    out = std::max(out, most[lane]);
    sum += total[lane];
  }
  return std::isfinite(sum) ? out : std::numeric_limits<double>::quiet_NaN();  // comparisons do not see what is not a number
}

PALPATE_CLONES void move(Columns rest, int count, const double a[9], const double o[3], MutableColumns out, double low[3], double high[3]) {
  const double infinity = std::numeric_limits<double>::infinity();
  double* const columns[3] = {out.x, out.y, out.z};
  for (int k = 0; k < 3; ++k) {
    Pack least = Pack{} + infinity, most = Pack{} - infinity;
    for (int i = 0; i < count; i += kLanes) {
      const Pack value = o[k] + a[3 * k] * PALPATE_LOAD(rest.x + i) + a[3 * k + 1] * PALPATE_LOAD(rest.y + i) + a[3 * k + 2] * PALPATE_LOAD(rest.z + i);
      PALPATE_STORE(columns[k] + i, value);
      least = value < least ? value : least;
      most = value > most ? value : most;
    }
    low[k] = infinity;
    high[k] = -infinity;
    for (int lane = 0; lane < kLanes; ++lane) {
      low[k] = std::min(low[k], least[lane]);
      high[k] = std::max(high[k], most[lane]);
    }
  }
}

PALPATE_CLONES int farthest(Columns p, int count, const double d[3]) { return farthest_inline(p, count, d); }

PALPATE_CLONES double most_along(Columns p, int count, const double d[3]) { return most_along_inline(p, count, d); }

PALPATE_CLONES bool ball_apart(Columns p, int count, const double c[3], double reach, int steps, double w[3]) {
  double v[3] = {c[0] - w[0], c[1] - w[1], c[2] - w[2]};
  for (int i = 0; i < steps; ++i) {
    const double length2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (!(length2 > reach * reach)) return false;
    const double along = v[0] * c[0] + v[1] * c[1] + v[2] * c[2] - most_along_inline(p, count, v);
    if (along > 0.0 && along * along > reach * reach * length2) return true;
    const int at = farthest_inline(p, count, v);
    const double e[3] = {p.x[at] - w[0], p.y[at] - w[1], p.z[at] - w[2]};  // from the witness to that corner, as far as |v| falls
    const double edge2 = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
    const double t = edge2 > 0.0 ? std::clamp((v[0] * e[0] + v[1] * e[1] + v[2] * e[2]) / edge2, 0.0, 1.0) : 0.0;
    for (int k = 0; k < 3; ++k) {
      w[k] += t * e[k];
      v[k] = c[k] - w[k];
    }
  }
  return false;
}

}  // namespace palpate::proxy
