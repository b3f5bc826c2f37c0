// A rasteriser in vector lanes: a row of pixels at a time.
//
// A pixel's middle (x, y) is inside a triangle where its three edge functions are not negative.  That of the
// edge from p to q,
//     e(x, y) = (q_x - p_x) (y - p_y) - (q_y - p_y) (x - p_x),
// is evaluated for p the corner with the lower number and multiplied by the sign of the turn: two triangles
// that share an edge then get values that are equal but for the sign, so that no pixel between them is lost,
// whatever the rounding.  A pixel on the edge belongs to both; its nearer depth stays.
//
// A pixel that is drawn again at another depth has layers: a height field has none.  The mark stands in the
// triangle's number, so that it costs no memory of its own.
#include <algorithm>
#include <cmath>

#include "contact/raster_kernels.h"

namespace palpate::contact::PALPATE_KERNELS {
namespace {

constexpr int kLanes = 2 * PALPATE_WIDTH;
static_assert(kRasterLanes % kLanes == 0);
typedef float Floats __attribute__((vector_size(4 * kLanes)));
typedef std::int32_t Ints __attribute__((vector_size(4 * kLanes)));

#define PALPATE_INLINE [[gnu::always_inline]] static inline

PALPATE_INLINE Floats& floats(float* p) { return *reinterpret_cast<Floats*>(p); }
PALPATE_INLINE Ints& ints(std::int32_t* p) { return *reinterpret_cast<Ints*>(p); }
PALPATE_INLINE const Floats& floats(const float* p) { return *reinterpret_cast<const Floats*>(p); }
PALPATE_INLINE const Ints& ints(const std::int32_t* p) { return *reinterpret_cast<const Ints*>(p); }
PALPATE_INLINE Floats all(float x) { return Floats{} + x; }
PALPATE_INLINE Ints all(std::int32_t x) { return Ints{} + x; }

/// 0.5, 1.5, ...: middles of the pixels of a block from its first.
PALPATE_INLINE Floats middles() {
  Floats out{};
  for (int l = 0; l < kLanes; ++l) out[l] = static_cast<float>(l) + 0.5f;
  return out;
}

PALPATE_INLINE bool any(Ints mask) {
  std::int32_t bits = 0;
  for (int l = 0; l < kLanes; ++l) bits |= mask[l];
  return bits != 0;
}

struct Edge {
  float px, py, dx, dy;
};

/// Signed so that the inside is positive; `turn` is the sign of the triangle's area.
PALPATE_INLINE Edge edge(const float* p, const float* q, bool swapped, float turn) {
  const float sign = swapped ? -turn : turn;
  const float* from = swapped ? q : p;
  const float* to = swapped ? p : q;
  return {from[0], from[1], sign * (to[0] - from[0]), sign * (to[1] - from[1])};
}

PALPATE_INLINE void draw_one(const float* vertices, const std::int32_t* corner, std::int32_t number,
                             Floats lane, float side, float layer_gap, const RasterTarget& target) {
  const float *p0 = vertices + 3 * corner[0], *p1 = vertices + 3 * corner[1], *p2 = vertices + 3 * corner[2];
  const float low_x = std::min(p0[0], std::min(p1[0], p2[0])),
              high_x = std::max(p0[0], std::max(p1[0], p2[0])),
              low_y = std::min(p0[1], std::min(p1[1], p2[1])),
              high_y = std::max(p0[1], std::max(p1[1], p2[1]));
  // the pixels whose middles lie within
  const int first_x = std::max(0, static_cast<int>(std::ceil(low_x - 0.5f))),
            last_x = std::min(target.width - 1, static_cast<int>(std::floor(high_x - 0.5f))),
            first_y = std::max(0, static_cast<int>(std::ceil(low_y - 0.5f))),
            last_y = std::min(target.height - 1, static_cast<int>(std::floor(high_y - 0.5f)));
  if (first_x > last_x || first_y > last_y) return;
  const float ux = p1[0] - p0[0], uy = p1[1] - p0[1], uw = p1[2] - p0[2], vx = p2[0] - p0[0],
              vy = p2[1] - p0[1], vw = p2[2] - p0[2];
  const float area = ux * vy - vx * uy;
  if (!(side * area > 0.0f)) return;
  const float turn = area > 0.0f ? 1.0f : -1.0f;
  const Edge e0 = edge(p1, p2, corner[1] > corner[2], turn), e1 = edge(p2, p0, corner[2] > corner[0], turn),
             e2 = edge(p0, p1, corner[0] > corner[1], turn);
  // w = p0.w + gx (x - p0.x) + gy (y - p0.y), never beyond the corners: a sliver's slope is wild
  const float gx = (uw * vy - vw * uy) / area, gy = (ux * vw - vx * uw) / area;
  const float low_w = std::min(p0[2], std::min(p1[2], p2[2])),
              high_w = std::max(p0[2], std::max(p1[2], p2[2]));
  const int first_block = first_x / kLanes * kLanes;
  for (int row = first_y; row <= last_y; ++row) {
    const float y = static_cast<float>(row) + 0.5f;
    const float r0 = e0.dx * (y - e0.py), r1 = e1.dx * (y - e1.py), r2 = e2.dx * (y - e2.py),
                rw = p0[2] + gy * (y - p0[1]);
    for (int block = first_block; block <= last_x; block += kLanes) {
      const Floats x = lane + static_cast<float>(block);
      const Floats w0 = r0 - e0.dy * (x - e0.px), w1 = r1 - e1.dy * (x - e1.px),
                   w2 = r2 - e2.dy * (x - e2.px);
      Floats w = rw + gx * (x - p0[0]);
      w = w < low_w ? all(low_w) : w;
      w = w > high_w ? all(high_w) : w;
      float* depth = target.depth + static_cast<std::ptrdiff_t>(row) * target.stride + block;
      std::int32_t* triangle = target.triangle + static_cast<std::ptrdiff_t>(row) * target.stride + block;
      const Floats before = floats(depth);
      const Ints inside = (w0 >= 0.0f) & (w1 >= 0.0f) & (w2 >= 0.0f), nearer = inside & (w < before),
                 old = ints(triangle), seen = old >= 0,
                 apart = inside & ((w < before - layer_gap) | (w > before + layer_gap)),
                 mark = seen & (old | apart) & all(kRasterLayered);
      floats(depth) = nearer ? w : before;
      ints(triangle) = (nearer ? all(number) : old) | mark;
    }
  }
}

void draw(const float* vertices, const std::int32_t* corners, int count, float side, float layer_gap,
          const RasterTarget& target) {
  const Floats lane = middles();
  for (int t = 0; t < count; ++t) draw_one(vertices, corners + 3 * t, t, lane, side, layer_gap, target);
}

int pair(const RasterTarget& a, const RasterTarget& b, float largest_gap, RasterPair* out) {
  RasterPair* next = out;
  Ints number{};
  for (int l = 0; l < kLanes; ++l) number[l] = l;
  for (int row = 0; row < a.height; ++row) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(row) * a.stride;
    for (int block = 0; block < a.width; block += kLanes) {
      const Ints ta = ints(a.triangle + at + block), tb = ints(b.triangle + at + block);
      const Ints both =  // a triangle may reach beyond the last column
          ((ta | tb) >= 0) & (number + block < a.width) &
          (floats(a.depth + at + block) + floats(b.depth + at + block) <= largest_gap);
      if (!any(both)) continue;
      for (int l = 0; l < kLanes; ++l)
        if (both[l])
          *next++ = {static_cast<std::uint32_t>(row * a.width + block + l),
                     static_cast<std::uint32_t>(ta[l] & ~kRasterLayered),
                     static_cast<std::uint32_t>(tb[l] & ~kRasterLayered),
                     static_cast<std::uint32_t>((ta[l] | tb[l]) & kRasterLayered)};
    }
  }
  return static_cast<int>(next - out);
}

}  // namespace

extern const RasterKernels kRaster;
const RasterKernels kRaster{draw, pair};

}  // namespace palpate::contact::PALPATE_KERNELS
