#include "proxy/lanes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::proxy {
namespace {

// GCC's vector types use whatever registers the function's target has.  Sums are formed lane by lane; with
// fused multiply-add they differ between targets by rounding, which affects bounds at rounding level and no
// force.
typedef double Pack __attribute__((vector_size(8 * kLanes)));
typedef double PackInMemory __attribute__((vector_size(8 * kLanes), may_alias, aligned(8)));
typedef long long Mask __attribute__((vector_size(8 * kLanes)));

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__SANITIZE_ADDRESS__)
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
    const Pack along =
        d[0] * PALPATE_LOAD(p.x + i) + d[1] * PALPATE_LOAD(p.y + i) + d[2] * PALPATE_LOAD(p.z + i);
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
    const Pack along =
        d[0] * PALPATE_LOAD(p.x + i) + d[1] * PALPATE_LOAD(p.y + i) + d[2] * PALPATE_LOAD(p.z + i);
    most = along > most ? along : most;
  }
  const auto greater = [](double a, double b) { return a > b ? a : b; };
  return greater(greater(greater(most[0], most[1]), greater(most[2], most[3])),
                 greater(greater(most[4], most[5]), greater(most[6], most[7])));
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

PALPATE_CLONES double residuals(Columns p, Columns rest, int count, const double a[9], const double o[3],
                                double* squares) {
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
  // Comparisons with NaN are false, so the maximum misses it and the sum does not.
  return std::isfinite(sum) ? out : std::numeric_limits<double>::quiet_NaN();
}

PALPATE_CLONES void move(Columns rest, int count, const double a[9], const double o[3], MutableColumns out,
                         double low[3], double high[3]) {
  const double infinity = std::numeric_limits<double>::infinity();
  double* const columns[3] = {out.x, out.y, out.z};
  for (int k = 0; k < 3; ++k) {
    Pack least = Pack{} + infinity, most = Pack{} - infinity;
    for (int i = 0; i < count; i += kLanes) {
      const Pack value = o[k] + a[3 * k] * PALPATE_LOAD(rest.x + i) +
                         a[3 * k + 1] * PALPATE_LOAD(rest.y + i) + a[3 * k + 2] * PALPATE_LOAD(rest.z + i);
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

PALPATE_CLONES double most_along(Columns p, int count, const double d[3]) {
  return most_along_inline(p, count, d);
}

// Full-width loads, then two shuffles per coordinate.
PALPATE_CLONES double take(const double* points, int stride, int count, Columns then, const double a[9],
                           const double o[3], MutableColumns out) {
  static_assert(kLanes == 8);
  Pack most = {}, total = {};
  const auto measure = [&](int i, const Pack& px, const Pack& py, const Pack& pz)
      __attribute__((always_inline)) {
    const Pack x = PALPATE_LOAD(then.x + i), y = PALPATE_LOAD(then.y + i), z = PALPATE_LOAD(then.z + i);
    PALPATE_STORE(out.x + i, px);
    PALPATE_STORE(out.y + i, py);
    PALPATE_STORE(out.z + i, pz);
    const Pack dx = px - (o[0] + a[0] * x + a[1] * y + a[2] * z);
    const Pack dy = py - (o[1] + a[3] * x + a[4] * y + a[5] * z);
    const Pack dz = pz - (o[2] + a[6] * x + a[7] * y + a[8] * z);
    const Pack square = dx * dx + dy * dy + dz * dz;
    most = most < square ? square : most;
    total += square;
  };
  int i = 0;
  for (; stride == 3 && i + kLanes <= count; i += kLanes) {
    const double* p = points + 3 * static_cast<long>(i);
    const Pack p0 = PALPATE_LOAD(p), p1 = PALPATE_LOAD(p + 8), p2 = PALPATE_LOAD(p + 16);
    const Pack x = __builtin_shufflevector(p0, p1, 0, 3, 6, 9, 12, 15, 0, 0),
               y = __builtin_shufflevector(p0, p1, 1, 4, 7, 10, 13, 0, 0, 0),
               z = __builtin_shufflevector(p0, p1, 2, 5, 8, 11, 14, 0, 0, 0);
    measure(i, __builtin_shufflevector(x, p2, 0, 1, 2, 3, 4, 5, 10, 13),
            __builtin_shufflevector(y, p2, 0, 1, 2, 3, 4, 8, 11, 14),
            __builtin_shufflevector(z, p2, 0, 1, 2, 3, 4, 9, 12, 15));
  }
  for (; i < count; i += kLanes) {
    Pack x, y, z;
    for (int lane = 0; lane < kLanes; ++lane) {
      const double* p = points + static_cast<long>(stride) * (i + lane < count ? i + lane : 0);
      x[lane] = p[0];
      y[lane] = p[1];
      z[lane] = p[2];
    }
    measure(i, x, y, z);
  }
  double largest = 0.0, sum = 0.0;
  for (int lane = 0; lane < kLanes; ++lane) {
    largest = std::max(largest, most[lane]);
    sum += total[lane];
  }
  return std::isfinite(sum) ? largest : std::numeric_limits<double>::quiet_NaN();
}

PALPATE_CLONES void gather(Columns p, const int* index, int count, const double origin[3],
                           MutableColumns out) {
  const double ox = origin[0], oy = origin[1], oz = origin[2];
  const double *px = p.x, *py = p.y, *pz = p.z;
  double* __restrict x = out.x, * __restrict y = out.y, * __restrict z = out.z;
  for (int i = 0; i < count; ++i) {
    x[i] = px[index[i]] - ox;
    y[i] = py[index[i]] - oy;
    z[i] = pz[index[i]] - oz;
  }
}

PALPATE_CLONES void balls_beyond(const double d[3], double limit, Columns c, const double* radii, int count,
                                 unsigned char* near) {
  for (int i = 0; i < count; i += kLanes) {
    const Mask beyond = d[0] * PALPATE_LOAD(c.x + i) + d[1] * PALPATE_LOAD(c.y + i) +
                            d[2] * PALPATE_LOAD(c.z + i) - PALPATE_LOAD(radii + i) >
                        limit;
    for (int lane = 0; lane < kLanes; ++lane) near[i + lane] = near[i + lane] && !beyond[lane];
  }
}

// Per lane: v points from a point w of the hull to the ball's centre, and s is the corner farthest along v.
// v.c - v.s > reach |v| proves the ball apart; |v| <= reach proves it near; otherwise w moves toward s as
// long as
// v| falls.
PALPATE_CLONES void balls_near(const HullColumns& hull, Columns c, const double* radii, int count, int steps,
                               unsigned char* near) {
  const Pack zero = {}, one = zero + 1.0;
  // Warm start from the previous pack: neighbours in the list are neighbours in space.
  Pack wx = zero + hull.inside[0], wy = zero + hull.inside[1], wz = zero + hull.inside[2];
  const auto any = [](const Mask& mask) __attribute__((always_inline)) {
    long long all = 0;
    for (int lane = 0; lane < kLanes; ++lane) all |= mask[lane];
    return all != 0;
  };
  for (int i = 0; i < count; i += kLanes) {
    const Pack cx = PALPATE_LOAD(c.x + i), cy = PALPATE_LOAD(c.y + i), cz = PALPATE_LOAD(c.z + i),
               r = PALPATE_LOAD(radii + i), reach = r + hull.margin;
    Mask apart = (hull.low[0] - cx > r) | (hull.low[1] - cy > r) | (hull.low[2] - cz > r) |
                 (cx - hull.high[0] > r) | (cy - hull.high[1] > r) | (cz - hull.high[2] > r);
    Mask open = ~apart;
    for (int step = 0; step < steps && any(open); ++step) {
      const Pack vx = cx - wx, vy = cy - wy, vz = cz - wz, length2 = vx * vx + vy * vy + vz * vz;
      open &= length2 > reach * reach;
      Pack most = zero - std::numeric_limits<double>::infinity(), sx = zero, sy = zero, sz = zero;
      for (int k = 0; k < hull.count; ++k) {
        const double px = hull.corners.x[k], py = hull.corners.y[k], pz = hull.corners.z[k];
        const Pack along = vx * px + vy * py + vz * pz;
        const Mask more = along > most;
        most = more ? along : most;
        sx = more ? zero + px : sx;
        sy = more ? zero + py : sy;
        sz = more ? zero + pz : sz;
      }
      const Pack clear = vx * cx + vy * cy + vz * cz - most;
      const Mask proven = open & (clear > zero) & (clear * clear > reach * reach * length2);
      apart |= proven;
      open &= ~proven;
      const Pack ex = sx - wx, ey = sy - wy, ez = sz - wz, edge2 = ex * ex + ey * ey + ez * ez;
      Pack t = (vx * ex + vy * ey + vz * ez) / (edge2 > zero ? edge2 : one);
      t = t > zero ? (t < one ? t : one) : zero;
      wx += t * ex;
      wy += t * ey;
      wz += t * ez;
    }
    for (int lane = 0; lane < kLanes; ++lane) near[i + lane] = !apart[lane];
  }
}

}  // namespace palpate::proxy
