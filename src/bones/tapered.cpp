#include <algorithm>
#include <cmath>
#include <numbers>

#include "bones/revolved.h"
#include "bones/shape.h"
#include "palpate/core/error.h"

namespace palpate::bones {
namespace {

using std::numbers::pi;

/// Profile along the axis, x from the head: balls of radii r0 at 0 and r1 at L, and the cone that touches
/// both.  With s = (r1 - r0) / L the cone touches the balls where their normals make the angle asin s with
/// the transverse plane: at x = c - s r, in a circle of radius r sqrt(1 - s^2).  For |s| >= 1 one ball
/// contains the other.
struct Profile {
  double r0, r1, length, low, high;  ///< extent of the bone, from low to high
  double cone_low, cone_high, cone_r0, cone_r1;

  explicit Profile(const Bone& bone)
      : r0(bone.head_radius), r1(bone.tail_radius), length((bone.tail - bone.head).norm()) {
    if (!(r0 > 0.0 && r1 > 0.0)) fail("bone \"{}\": radii {} and {} m must be positive", bone.name, r0, r1);
    const double s = length > 0.0 ? (r1 - r0) / length : (r1 >= r0 ? 1.0 : -1.0);
    if (s >= 1.0) r0 = 0.0;  // one ball, about the tail
    if (s <= -1.0) r1 = 0.0;
    if (std::abs(s) >= 1.0) {
      const double c = s > 0.0 ? length : 0.0, r = s > 0.0 ? r1 : r0;
      low = c - r, high = c + r;
      cone_low = cone_high = s > 0.0 ? low : high;
      cone_r0 = cone_r1 = 0.0;
      return;
    }
    const double across = std::sqrt(1.0 - s * s);
    low = -r0, high = length + r1;
    cone_low = -s * r0, cone_high = length - s * r1;
    cone_r0 = across * r0, cone_r1 = across * r1;
  }
  double square_at(double x) const {
    if (x < cone_low) return std::max(0.0, r0 * r0 - x * x);
    if (x > cone_high) return std::max(0.0, r1 * r1 - (x - length) * (x - length));
    const double t = cone_high > cone_low ? (x - cone_low) / (cone_high - cone_low) : 0.0,
                 r = cone_r0 + t * (cone_r1 - cone_r0);
    return r * r;
  }
};

/// Integrates over x by three Gauss points per piece, exact for polynomials up to degree 5.
template <class F>
double integral(const Profile& p, const F& f) {
  constexpr double kPlace = 0.7745966692414834, kOuter = 5.0 / 9.0, kInner = 8.0 / 9.0;
  double sum = 0.0;
  const double ends[] = {p.low, p.cone_low, p.cone_high, p.high};
  for (int i = 0; i < 3; ++i) {
    const double middle = 0.5 * (ends[i] + ends[i + 1]), half = 0.5 * (ends[i + 1] - ends[i]);
    sum += half * (kOuter * (f(middle - kPlace * half) + f(middle + kPlace * half)) + kInner * f(middle));
  }
  return sum;
}

}  // namespace

// Slices of squared radius c(x), quadratic on each piece:  V = pi int c,  x_m = pi int x c / V,  along the
// axis pi/2 int c^2,  across pi int (c^2/4 + (x - x_m)^2 c).
TaperedBone tapered_bone(const Bone& bone) {
  const Profile p(bone);
  TaperedBone out;
  out.volume = pi * integral(p, [&](double x) { return p.square_at(x); });
  const double middle = pi * integral(p, [&](double x) { return x * p.square_at(x); }) / out.volume;
  const double along = 0.5 * pi * integral(p, [&](double x) { return p.square_at(x) * p.square_at(x); });
  const double across =
      0.5 * along + pi * integral(p, [&](double x) { return (x - middle) * (x - middle) * p.square_at(x); });
  out.unit_moments = Vec3(across, across, along) / out.volume;
  const Vec3 axis = p.length > 0.0 ? Vec3((bone.tail - bone.head) / p.length) : Vec3::UnitZ();
  out.frame = {Quat::FromTwoVectors(Vec3::UnitZ(), axis), bone.head + middle * axis};
  return out;
}

TriMesh tapered_bone_surface(const Bone& bone) {
  constexpr int kCapRings = 6;
  const Profile p(bone);
  const double middle = (tapered_bone(bone).frame.translation - bone.head)
                            .dot(p.length > 0.0 ? Vec3((bone.tail - bone.head) / p.length) : Vec3::UnitZ());
  std::vector<Eigen::Vector2d> profile;
  const auto add = [&](double x) { profile.emplace_back(std::sqrt(p.square_at(x)), x - middle); };
  const auto cap = [&](double c, double r, double from, double to) {  // equal steps of latitude
    const double first = std::asin(std::clamp((from - c) / r, -1.0, 1.0)),
                 last = std::asin(std::clamp((to - c) / r, -1.0, 1.0));
    for (int i = 0; i <= kCapRings; ++i) add(c + r * std::sin(first + (last - first) * i / kCapRings));
  };
  if (p.r0 > 0.0) cap(0.0, p.r0, p.low, p.r1 > 0.0 ? p.cone_low : p.high);
  if (p.r1 > 0.0) cap(p.length, p.r1, p.r0 > 0.0 ? p.cone_high : p.low, p.high);
  profile.front().x() = profile.back().x() = 0.0;
  return revolved(profile);
}

}  // namespace palpate::bones
