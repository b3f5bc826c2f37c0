#include "noise.h"

#include <cmath>
#include <cstdint>

namespace palpate::shapes {
namespace {

/// Mixes all bits.  Multiplications by odd numbers and xor-shifts are invertible, so no two inputs share an
/// output.
std::uint32_t mix(std::uint32_t h) {
  h ^= h >> 16;
  h *= 0x7feb352dU;
  h ^= h >> 15;
  h *= 0x846ca68bU;
  return h ^ (h >> 16);
}

std::uint32_t hash(int i, int j, int k, unsigned seed) {
  std::uint32_t h = mix(static_cast<std::uint32_t>(i) + 0x9e3779b9U * (seed + 1));
  h = mix(h + static_cast<std::uint32_t>(j));
  return mix(h + static_cast<std::uint32_t>(k));
}

/// Returns the dot product of one of the 12 directions to the edges of a cube with the offset from the
/// lattice point.
double slope(std::uint32_t h, double x, double y, double z) {
  const std::uint32_t which = h % 12;
  const double u = which < 8 ? x : y, v = which < 4 ? y : z;
  return (which & 1U ? -u : u) + (which & 2U ? -v : v);
}

double fade(double t) { return t * t * t * (t * (6.0 * t - 15.0) + 10.0); }
double between(double a, double b, double t) { return a + t * (b - a); }

}  // namespace

double noise(const Vec3& p, unsigned seed) {
  const Vec3 cell = p.array().floor();
  const int i = static_cast<int>(cell.x()), j = static_cast<int>(cell.y()), k = static_cast<int>(cell.z());
  const Vec3 d = p - cell;
  const auto corner = [&](int a, int b, int c) {
    return slope(hash(i + a, j + b, k + c, seed), d.x() - a, d.y() - b, d.z() - c);
  };
  const double u = fade(d.x()), v = fade(d.y()), w = fade(d.z());
  const double low =
      between(between(corner(0, 0, 0), corner(1, 0, 0), u), between(corner(0, 1, 0), corner(1, 1, 0), u), v);
  const double high =
      between(between(corner(0, 0, 1), corner(1, 0, 1), u), between(corner(0, 1, 1), corner(1, 1, 1), u), v);
  return between(low, high, w);
}

double chance(int i, unsigned seed) { return hash(i, 0, 0, seed) / 4294967296.0; }

}  // namespace palpate::shapes
