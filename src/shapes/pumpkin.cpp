#include "pumpkin.h"

#include <array>
#include <cmath>
#include <numbers>

#include "contour.h"
#include "noise.h"
#include "solids.h"

// Twelve ribs around an axis, each an ellipsoid of slightly different size.  Two neighbours form a groove;
// all together form the dimple that holds the stem, which is bent and five-cornered.  0.30 m across.
namespace palpate::shapes {
namespace {

constexpr int kRibs = 12;

struct Rib {
  double c, s, shift, grown;
};

const Rib& rib_of(int i) {
  static const std::array<Rib, kRibs> ribs = [] {
    std::array<Rib, kRibs> out{};
    for (int own = 0; own < kRibs; ++own) {
      const double angle = 2.0 * std::numbers::pi * (own + 0.22 * (chance(own, 1) - 0.5)) / kRibs;
      out[static_cast<std::size_t>(own)] = {std::cos(angle), std::sin(angle), 0.006 * (chance(own, 3) - 0.5),
                                            1.0 + 0.07 * (chance(own, 2) - 0.5)};
    }
    return out;
  }();
  return ribs[static_cast<std::size_t>((i + 2 * kRibs) % kRibs)];
}

/// Distance to rib i (modulo their number); p is relative to the axis.
double rib(const Vec3& p, int i, bool fine) {
  const Rib& own = rib_of(i);
  const Vec3 q(own.c * p.x() + own.s * p.y(), own.c * p.y() - own.s * p.x(), p.z() + own.shift);
  return ellipsoid(q, {0.073, 0, 0}, Vec3(fine ? 0.077 : 0.075, 0.037, 0.107) * own.grown);
}

double ribs(const Vec3& p, bool fine) {
  const double place = std::atan2(p.y(), p.x()) * kRibs / (2.0 * std::numbers::pi);
  const int nearest = static_cast<int>(std::lround(place));
  double d = rib(p, nearest, fine);
  for (const int side : {-1, 1}) d = join(d, rib(p, nearest + side, fine), fine ? 0.009 : 0.030);
  for (const int side : {-2, 2}) d = join(d, rib(p, nearest + side, fine), fine ? 0.009 : 0.030);
  return join(d, ellipsoid(p, {0, 0, 0}, {0.075, 0.075, 0.077}), 0.02);
}

double stem(const Vec3& p, bool fine) {
  const Vec3 foot(0, 0, 0.070), knee(0.004, -0.003, 0.112), end(0.026, -0.014, 0.146);
  const Vec3 axis = p.z() < knee.z()
                        ? Vec3(foot + (knee - foot) * ((p.z() - foot.z()) / (knee.z() - foot.z())))
                        : Vec3(knee + (end - knee) * ((p.z() - knee.z()) / (end.z() - knee.z())));
  double d = join(limb(p, foot, knee, 0.021, 0.0125), limb(p, knee, end, 0.0125, 0.0150), 0.010);
  d = join(d, ellipsoid(p, {0, 0, 0.082}, {0.030, 0.030, 0.010}), 0.012);
  const double radius = std::hypot(p.x() - axis.x(), p.y() - axis.y());
  const double turn = std::atan2(p.y() - axis.y(), p.x() - axis.x()) + 9.0 * (p.z() - 0.08);
  if (fine) d -= 0.0020 * std::cos(5.0 * turn) * ramp(radius, 0.003, 0.009);
  // cut end of the stem
  return meet(d, (p - Vec3(0.024, -0.013, 0.147)).dot(Vec3(0.5, -0.25, 0.83).normalized()), 0.003);
}

/// Returns the height of the skin: shallow dents, a few warts, fine streaks along the ribs.
double relief(const Vec3& p, double wavelength) {
  double out = 0.0011 * noise(p / 0.045, 21);
  if (wavelength < 0.016) out += 0.0005 * noise(p / 0.016, 22);
  const double wart = noise(p / 0.013, 23);
  if (wavelength < 0.012) out += 0.0016 * ramp(wart, 0.42, 0.75);
  const double radius = std::hypot(p.x(), p.y()), turn = std::atan2(p.y(), p.x());
  const double number = 12.0 * kRibs;
  const double fade = ramp(2.0 * std::numbers::pi * radius / number, wavelength, 1.5 * wavelength);
  return out + 0.00035 * fade * std::cos(number * turn + 2.0 * noise(p / 0.03, 24));
}

double pumpkin(const Vec3& p, bool fine, double wavelength) {
  double d = ribs(p, fine);
  if (fine && std::abs(d) < 0.008) d -= relief(p, wavelength);
  return join(d, stem(p, fine), fine ? 0.006 : 0.012);
}

}  // namespace

Shape make_pumpkin(const Resolution& resolution) {
  Shape shape;
  shape.name = "pumpkin";
  shape.tetrahedra = 10000;
  shape.inside = [](const Vec3& p) { return pumpkin(p, false, 0.0); };
  Blueprint plan;
  plan.inside = shape.inside;
  plan.low = Vec3(-0.18, -0.18, -0.14);
  plan.high = Vec3(0.18, 0.18, 0.18);
  plan.lattice = 0.0045;
  shape.base = contour(plan, resolution.base_vertices);
  const double edge = std::sqrt(2.0 / std::sqrt(3.0) * 0.27 / resolution.skin_vertices);
  plan.inside = [wavelength = 3.0 * edge](const Vec3& p) { return pumpkin(p, true, wavelength); };
  plan.size = [](const Vec3& p) {
    return p.z() > 0.06 && std::hypot(p.x(), p.y()) < 0.05
               ? 1.0 - 0.4 * ramp(0.05 - std::hypot(p.x(), p.y()), 0.0, 0.02) * ramp(p.z(), 0.06, 0.08)
               : 1.0;
  };
  plan.lattice = 0.0035;
  plan.lipschitz = 2.0;
  shape.skin = contour(plan, resolution.skin_vertices);
  return shape;
}

}  // namespace palpate::shapes
