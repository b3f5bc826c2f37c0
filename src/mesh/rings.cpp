#include "rings.h"

#include <algorithm>
#include <cmath>

#include "lattice.h"

namespace palpate::mesh {
namespace {

/// Growth of the element size per unit of depth: one layer of the surface's size is kept before the first
/// doubling.
constexpr double kGrowth = 0.45;
/// Bounds of the stretch; beyond them it would flatten elements more than the grading is worth (where few
/// layers leave no room to halve).
constexpr double kLeastStretch = 0.5, kMostStretch = 1.45;

/// Elements double as soon as the target size, h (1 + kGrowth depth / h) and at most g h, is closer to the
/// double size.
bool should_halve(const Ring& ring, const Ring& outermost, double grading) {
  const double size = ring.radius / ring.frequency, surface_size = outermost.radius / outermost.frequency;
  const double requested =
      std::min(surface_size + kGrowth * (outermost.radius - ring.radius), grading * surface_size);
  return ring.frequency % 2 == 0 && ring.frequency > 2 && requested >= std::sqrt(2.0) * size * (1 - 1e-12);
}

}  // namespace

// A layer of elements of size s = r/m is s thick: r - r/m = r (m-1)/m, so s is kept when m falls by one, and
// r is 0 when m is.  Between s and 2 s the layer is 1.5 s thick.
std::vector<Ring> rings(double radius, int frequency, double grading) {
  std::vector<Ring> out = {{frequency, radius}};
  while (out.back().frequency > 1) {
    const Ring& ring = out.back();
    const double size = ring.radius / ring.frequency;
    if (should_halve(ring, out.front(), grading))
      out.push_back({ring.frequency / 2, ring.radius - 1.5 * size});
    else
      out.push_back({ring.frequency - 1, ring.radius - size});
  }
  const double surface_size = radius / frequency, middle_size = out.back().radius;
  const double stretch = std::clamp(grading * surface_size / middle_size, kLeastStretch, kMostStretch);
  for (Ring& ring : out) ring.radius = radius * graded(ring.radius / radius, stretch);
  out.push_back({0, 0.0});
  return out;
}

}  // namespace palpate::mesh
