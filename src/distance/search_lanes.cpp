// Nearest-face search for sixteen points at a time. Each lane holds one point; the triangle's data are
// broadcast to all lanes.
//
// Let d be the distance from the triangle's plane and l the largest distance beyond an edge, measured in that
// plane. d^2 + max(l, 0)^2 is the squared distance where the foot lies on the face or on the inside of an
// edge, and a lower bound on it where the nearest feature is a corner. Projections are clamped to the edges
// only if this value is below the smallest distance so far.
#ifdef __AVX2__
#include <immintrin.h>
#endif

#include "distance/search_kernels.h"

namespace palpate::distance::PALPATE_KERNELS {
namespace {

typedef float Floats __attribute__((vector_size(64)));
typedef std::int32_t Ints __attribute__((vector_size(64)));
typedef double Four __attribute__((vector_size(32)));
typedef double FourInMemory __attribute__((vector_size(32), may_alias, aligned(8)));

#define PALPATE_INLINE [[gnu::always_inline]] static inline

PALPATE_INLINE Floats& floats(float* p) { return *reinterpret_cast<Floats*>(p); }
PALPATE_INLINE const Floats& floats(const float* p) { return *reinterpret_cast<const Floats*>(p); }
PALPATE_INLINE Ints& ints(std::int32_t* p) { return *reinterpret_cast<Ints*>(p); }
PALPATE_INLINE Floats all(float x) { return Floats{} + x; }
PALPATE_INLINE Ints all(std::int32_t x) { return Ints{} + x; }
PALPATE_INLINE Floats least(Floats x, Floats y) { return x < y ? x : y; }
PALPATE_INLINE Floats most(Floats x, Floats y) { return x > y ? x : y; }
PALPATE_INLINE Floats size(Floats x) { return x < 0.0f ? -x : x; }
PALPATE_INLINE Four load(const double* p) { return *reinterpret_cast<const FourInMemory*>(p); }
PALPATE_INLINE void store(double* p, Four x) { *reinterpret_cast<FourInMemory*>(p) = x; }

/// Returns one bit per lane.
PALPATE_INLINE unsigned bits(Ints mask) {
#if defined(__AVX512DQ__)
  return static_cast<unsigned>(_mm512_movepi32_mask(reinterpret_cast<__m512i&>(mask)));
#elif defined(__AVX2__)
  const __m256* half = reinterpret_cast<const __m256*>(&mask);
  return static_cast<unsigned>(_mm256_movemask_ps(half[0])) |
         static_cast<unsigned>(_mm256_movemask_ps(half[1])) << 8;
#else
  unsigned out = 0;
  for (int l = 0; l < kLanes; ++l) out |= (static_cast<unsigned>(mask[l]) & 1u) << l;
  return out;
#endif
}

PALPATE_INLINE float largest(Floats x) {
  float out = x[0];
  for (int l = 1; l < kLanes; ++l) out = x[l] > out ? x[l] : out;
  return out;
}
PALPATE_INLINE float smallest(Floats x) { return -largest(-x); }

struct Vectors {
  Floats x, y, z;
};
PALPATE_INLINE Vectors operator-(Vectors a, Vectors b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
PALPATE_INLINE Floats dot(Vectors a, Vectors b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
PALPATE_INLINE Vectors cross(Vectors a, Vectors b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
PALPATE_INLINE Vectors times(Vectors a, Floats s) { return {a.x * s, a.y * s, a.z * s}; }

void evaluate(const double* nodes, const int* carriers, const double* weights, const int* list, int count,
              double* out) {
  for (int i = 0; i < count; ++i) {
    const int* c = carriers + 4 * list[i];
    const double* w = weights + 4 * list[i];
    store(out + 4 * list[i], w[0] * load(nodes + 4 * c[0]) + w[1] * load(nodes + 4 * c[1]) +
                                 w[2] * load(nodes + 4 * c[2]) + w[3] * load(nodes + 4 * c[3]));
  }
}

void take(const double* points, int count, const double* before, double* out, double* sum, double* moved) {
  Four total{}, change{};
  for (int i = 0; i < count; ++i) {
    const Four x = {points[3 * i], points[3 * i + 1], points[3 * i + 2], 0.0};
    total += x;
    change += x - load(before + 4 * i);
    store(out + 4 * i, x);
  }
  store(sum, total);
  store(moved, change);
}

/// Returns the sums of the entries of four vectors.
PALPATE_INLINE Four sums(const Four* a) {
  const Four ab =
      __builtin_shufflevector(a[0], a[1], 0, 4, 2, 6) + __builtin_shufflevector(a[0], a[1], 1, 5, 3, 7);
  const Four cd =
      __builtin_shufflevector(a[2], a[3], 0, 4, 2, 6) + __builtin_shufflevector(a[2], a[3], 1, 5, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

double compare(const double* now, const double* before, int count, const double* about, double* low,
               double* high) {
  const Four middle = load(about);
  Four l = load(low), h = load(high), most{};
  for (int i = 0; i < count; i += 4) {
    Four squares[4];
    for (int k = 0; k < 4; ++k) {
      const int at = i + k < count ? i + k : count - 1;
      const Four x = load(now + 4 * at);
      l = x < l ? x : l;
      h = x > h ? x : h;
      const Four moved = (before ? x - load(before + 4 * at) : x) - middle;
      squares[k] = moved * moved;
    }
    const Four squared = sums(squares);
    most = squared > most ? squared : most;
  }
  store(low, l);
  store(high, h);
  double out = 0.0;
  for (int k = 0; k < 4; ++k) out = most[k] > out ? most[k] : out;
  return out;
}

void bound(const double* vertices, const int* list, int count, double* low, double* high) {
  Four l = load(vertices + 4 * list[0]), h = l;
  for (int i = 1; i < count; ++i) {
    const Four x = load(vertices + 4 * list[i]);
    l = x < l ? x : l;
    h = x > h ? x : h;
  }
  store(low, l);
  store(high, h);
}

/// Offset of a plane beyond every search distance: used for lanes without a triangle, and for triangles
/// without area, whose edges belong to other triangles as well.
constexpr float kFar = 1e9f;

void planes(const double* vertices, const int* corners, int count, const double* origin, float* out) {
  const Four about = {origin[0], origin[1], origin[2], 0.0};
  for (int t = 0; t < 32; ++t)
    for (int k = 0; k < 3; ++k) {
      const Four x = load(vertices + 4 * corners[3 * (t < count ? t : 0) + k]) - about;
      for (int d = 0; d < 3; ++d) out[32 * (16 + 3 * k + d) + t] = static_cast<float>(x[d]);
    }
  const auto row = [&](int r, int half) -> Floats& { return floats(out + 32 * r + 16 * half); };
  for (int half = 0; half < 2; ++half) {
    const auto corner = [&](int k) {
      return Vectors{row(16 + 3 * k, half), row(17 + 3 * k, half), row(18 + 3 * k, half)};
    };
    const Vectors edge[3] = {corner(2) - corner(1), corner(0) - corner(2), corner(1) - corner(0)};
    const Vectors area = cross(edge[0], edge[1]);
    const Floats size2 = dot(area, area);
    Ints lane;
    for (int l = 0; l < kLanes; ++l) lane[l] = l;
    const Ints is_flat = (size2 <= 1e-37f) | (lane >= all(static_cast<std::int32_t>(count - 16 * half)));
    Floats root;
    for (int l = 0; l < kLanes; ++l) root[l] = __builtin_sqrtf(size2[l]);
    const Floats inverse = is_flat ? Floats{} : 1.0f / root;
    const Vectors n = times(area, inverse);
    row(0, half) = n.x, row(1, half) = n.y, row(2, half) = n.z;
    row(3, half) = is_flat ? all(kFar) : -dot(n, corner(0));
    for (int k = 0; k < 3; ++k) {
      const Floats length2 = dot(edge[k], edge[k]);
      Floats length;
      for (int l = 0; l < kLanes; ++l) length[l] = __builtin_sqrtf(length2[l]);
      const Vectors q = times(cross(edge[k], n), is_flat ? Floats{} : 1.0f / length);
      row(4 + 4 * k, half) = q.x, row(5 + 4 * k, half) = q.y, row(6 + 4 * k, half) = q.z;
      row(7 + 4 * k, half) = -dot(q, corner((k + 1) % 3));
      row(25 + k, half) = is_flat ? Floats{} : 1.0f / length2;
    }
  }
}

/// Returns an upper bound on (sqrt(d2) + s)^2: 2 s d <= e d^2 + s^2/e, with e = 1/128.
PALPATE_INLINE Floats loosened(Floats distance2, float slack2) {
  return distance2 * (1.0f + 1.0f / 128) + 129.0f * slack2;
}

struct Best {
  Floats distance2, height;
  Ints face;
};

PALPATE_INLINE void test(const Vectors& x, const float* plane, int t, int face, float slack2, Best& best) {
  const float* p = plane + t;
  const auto along = [&](int r) {
    return x.x * p[32 * r] + x.y * p[32 * r + 32] + x.z * p[32 * r + 64] + p[32 * r + 96];
  };
  const Floats d = along(0);
  const Floats beyond[3] = {along(4), along(8), along(12)};
  const Floats l = most(most(beyond[0], Floats{}), most(beyond[1], beyond[2]));
  Floats d2 = d * d + l * l;
  if (!bits(d2 <= loosened(best.distance2, slack2))) return;
  const Ints is_out = l > 0.0f;
  if (bits(is_out)) {
    Floats edges = all(1e30f);
    for (int k = 0; k < 3; ++k) {
      const Ints is_beyond = beyond[k] > 0.0f;
      if (!bits(is_beyond)) continue;
      const float* from = p + 32 * (16 + 3 * ((k + 1) % 3));
      const float* to = p + 32 * (16 + 3 * ((k + 2) % 3));
      const Vectors v = {x.x - from[0], x.y - from[32], x.z - from[64]};
      const Vectors e = {all(to[0] - from[0]), all(to[32] - from[32]), all(to[64] - from[64])};
      const Floats s = least(all(1.0f), most(Floats{}, dot(v, e) * p[32 * (25 + k)]));
      const Vectors r = v - times(e, s);
      edges = is_beyond ? least(edges, dot(r, r)) : edges;
    }
    d2 = is_out ? edges : d2;
  }
  const Ints is_nearer = (d2 < best.distance2) | ((d2 == best.distance2) & (face < best.face));
  best.distance2 = is_nearer ? d2 : best.distance2;
  best.height = is_nearer ? (is_out ? Floats{} : d) : best.height;
  best.face = is_nearer ? all(static_cast<std::int32_t>(face)) : best.face;
}

/// Returns one bit per triangle, sixteen in all: set where some point of the box c +- h is within the bound.
PALPATE_INLINE unsigned near_triangles(const float* plane, const float c[3], const float h[3], float bound2) {
  const auto row = [&](int r) -> const Floats& { return floats(plane + 32 * r); };
  const auto middle = [&](int r) {
    return row(r) * c[0] + row(r + 1) * c[1] + row(r + 2) * c[2] + row(r + 3);
  };
  const auto half = [&](int r) {
    return size(row(r)) * h[0] + size(row(r + 1)) * h[1] + size(row(r + 2)) * h[2];
  };
  const Floats d = most(Floats{}, size(middle(0)) - half(0));
  const Floats l =
      most(most(Floats{}, middle(4) - half(4)), most(middle(8) - half(8), middle(12) - half(12)));
  return bits(d * d + l * l <= bound2);
}

constexpr int kQuarters = 4;

/// Boxes of four points each, and of all sixteen: fewer triangles are near one of the small boxes than near
/// the large one.
struct QuarterBoxes {
  float c[kQuarters][3], h[kQuarters][3];  // Centres and half edges.
  float low[3], high[3];
};
PALPATE_INLINE void bound_quarters(const Packet& packet, QuarterBoxes& out) {
  for (int d = 0; d < 3; ++d) {
    for (int q = 0; q < kQuarters; ++q) {
      const float* p = packet.x[d] + 4 * q;
      float least_x = p[0], most_x = p[0];
      for (int i = 1; i < 4; ++i) {
        least_x = p[i] < least_x ? p[i] : least_x;
        most_x = p[i] > most_x ? p[i] : most_x;
      }
      out.c[q][d] = 0.5f * (least_x + most_x);
      out.h[q][d] = 0.5f * (most_x - least_x);
      out.low[d] = q && out.low[d] < least_x ? out.low[d] : least_x;
      out.high[d] = q && out.high[d] > most_x ? out.high[d] : most_x;
    }
  }
}

/// Clusters of the nearest faces so far.
struct FirstClusters {
  int cluster[kQuarters], count = 0;
};
PALPATE_INLINE bool contains(const FirstClusters& first, int cluster) {
  bool known = false;
  for (int i = 0; i < first.count; ++i) known |= first.cluster[i] == cluster;
  return known;
}
PALPATE_INLINE void collect(const Packet& packet, FirstClusters& first) {
  for (int q = 0; q < kQuarters; ++q) {
    if (packet.face[4 * q] < 0) continue;
    const int cluster = packet.face[4 * q] >> 5;
    if (!contains(first, cluster)) first.cluster[first.count++] = cluster;
  }
}

/// Returns which of the kLanes clusters from `group` on may be nearer than the bound.
PALPATE_INLINE unsigned open_clusters(const Targets& targets, int group, const QuarterBoxes& boxes,
                                      Floats bound) {
  Floats away2 = {};
  for (int d = 0; d < 3; ++d) {
    const float* row = targets.boxes + d * targets.box_stride + group;
    const Floats gap = most(
        Floats{}, most(floats(row) - boxes.high[d], boxes.low[d] - floats(row + 3 * targets.box_stride)));
    away2 += gap * gap;
  }
  unsigned open = bits(away2 <= loosened(all(largest(bound)), targets.slack2));
  if (targets.cluster_count - group < kLanes) open &= (1u << (targets.cluster_count - group)) - 1;
  return open;
}

/// Lists the faces of a cluster that may be nearer than the bound. Returns their number.
PALPATE_INLINE int list_near_faces(const Targets& targets, int cluster, const QuarterBoxes& boxes,
                                   Floats bound, int* faces) {
  const float* plane = targets.planes + static_cast<std::ptrdiff_t>(cluster) * kPlaneFloats;
  float quarter[kQuarters];
  for (int q = 0; q < kQuarters; ++q) {
    quarter[q] = bound[4 * q];
    for (int i = 1; i < 4; ++i) quarter[q] = bound[4 * q + i] > quarter[q] ? bound[4 * q + i] : quarter[q];
    quarter[q] = quarter[q] * (1.0f + 1.0f / 128) + 129.0f * targets.slack2;
  }
  int count = 0;
  for (int half = 0; half < 2; ++half) {
    unsigned near = 0;
    for (int q = 0; q < kQuarters; ++q)
      near |= near_triangles(plane + 16 * half, boxes.c[q], boxes.h[q], quarter[q]);
    for (; near; near &= near - 1) faces[count++] = 32 * cluster + 16 * half + __builtin_ctz(near);
  }
  return count;
}

// The search order is: single faces, then the clusters of the nearest faces so far, which tighten the bound,
// then all other clusters. They share one copy of test(), so that a distance has the same bits wherever it is
// computed.
long search(Packet& packet, const Targets& targets) {
  const Vectors x = {floats(packet.x[0]), floats(packet.x[1]), floats(packet.x[2])};
  Best best = {floats(packet.distance2), floats(packet.height), ints(packet.face)};
  long tested = 0;
  QuarterBoxes boxes;
  FirstClusters first;
  if (targets.cluster_count > 0) {
    bound_quarters(packet, boxes);
    collect(packet, first);
  }
  const int* list = targets.faces;
  int count = targets.face_count, group = -kLanes, next = 0;
  unsigned open = 0;
  int near_faces[32];
  for (;;) {
    for (int i = 0; i < count; ++i) {
      const int face = list[i];
      test(x, targets.planes + static_cast<std::ptrdiff_t>(face >> 5) * kPlaneFloats, face & 31, face,
           targets.slack2, best);
    }
    tested += count;
    const Floats bound = loosened(best.distance2, targets.slack2);
    while (!open && next == first.count) {
      group += kLanes;
      if (group >= targets.cluster_count) {
        floats(packet.distance2) = best.distance2;
        floats(packet.height) = best.height;
        ints(packet.face) = best.face;
        return tested;
      }
      open = open_clusters(targets, group, boxes, bound);
    }
    count = 0;
    list = near_faces;
    int cluster = 0;
    if (next < first.count) {
      cluster = first.cluster[next++];
    } else {
      cluster = targets.clusters[group + __builtin_ctz(open)];
      open &= open - 1;
      if (contains(first, cluster)) continue;
    }
    count = list_near_faces(targets, cluster, boxes, bound, near_faces);
  }
}

}  // namespace

extern const SearchKernels kSearch;
const SearchKernels kSearch{evaluate, take, compare, bound, planes, search};

}  // namespace palpate::distance::PALPATE_KERNELS
