// A vertex fills four lanes, its coordinates and a padding that is never read, so that each corner of a face
// is one load.
#include <limits>

#include "contact/face_kernels.h"

namespace palpate::contact::PALPATE_KERNELS {
namespace {

typedef double Four __attribute__((vector_size(32)));
typedef double FourInMemory __attribute__((vector_size(32), may_alias, aligned(8)));

#define PALPATE_INLINE [[gnu::always_inline]] static inline

PALPATE_INLINE Four load(const double* p) { return *reinterpret_cast<const FourInMemory*>(p); }
PALPATE_INLINE void store(double* p, Four x) { *reinterpret_cast<FourInMemory*>(p) = x; }
PALPATE_INLINE Four least(Four x, Four y) { return x < y ? x : y; }
PALPATE_INLINE Four most(Four x, Four y) { return x > y ? x : y; }

void to_axes(const double* world, int count, const double rows[9], const double origin[3], double* out,
             double* wide) {
  const Four x = {rows[0], rows[3], rows[6], 0.0}, y = {rows[1], rows[4], rows[7], 0.0},
             z = {rows[2], rows[5], rows[8], 0.0};
  for (int i = 0; i < count; ++i, world += 3, out += 3, wide += 4) {
    const Four at = (world[0] - origin[0]) * x + (world[1] - origin[1]) * y + (world[2] - origin[2]) * z;
    store(wide, at);
    for (int k = 0; k < 3; ++k) out[k] = at[k];
  }
}

// With the sides e and f from the first corner twice the area is e_x f_y - e_y f_x.
double bound(const double* wide, const int* corners, int count, double side, double low[4], double high[4]) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Four lowest = Four{} + kInfinity, highest = Four{} - kInfinity, area = Four{} + kInfinity;
  for (int i = 0; i < count; ++i, corners += 3) {
    const Four p = load(wide + 4 * corners[0]), q = load(wide + 4 * corners[1]),
               r = load(wide + 4 * corners[2]);
    lowest = least(lowest, least(p, least(q, r)));
    highest = most(highest, most(p, most(q, r)));
    const Four e = q - p, f = r - p, products = e * __builtin_shufflevector(f, f, 1, 0, 2, 3);
    area = least(area, side * (products - __builtin_shufflevector(products, products, 1, 0, 2, 3)));
  }
  store(low, lowest);
  store(high, highest);
  return area[0];
}

}  // namespace

extern const FaceKernels kFaces;
const FaceKernels kFaces{to_axes, bound};

}  // namespace palpate::contact::PALPATE_KERNELS
