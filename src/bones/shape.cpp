#include "bones/shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bones/revolved.h"
#include "palpate/core/error.h"
#include "palpate/core/named_enum.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/mesh/generators.h"

namespace palpate::bones {
namespace {

using std::numbers::pi;

constexpr int kCapRings = 6;

TriMesh capsule_surface(double radius, double length) {
  std::vector<Eigen::Vector2d> profile;
  for (const double cap : {-1.0, 1.0})
    for (int i = 0; i <= kCapRings; ++i) {
      const double latitude = 0.5 * pi * (cap < 0.0 ? i - kCapRings : i) / kCapRings;
      const bool pole = i == (cap < 0.0 ? 0 : kCapRings);
      profile.emplace_back(pole ? 0.0 : radius * std::cos(latitude),
                           0.5 * cap * length + radius * std::sin(latitude));
    }
  return revolved(profile);
}

/// Returns the moments of the shape filled evenly with mass 1; L is its length along z, if any.
///   sphere     2/5 r^2
///   box        (b^2 + c^2)/12
///   cylinder   axis r^2/2, across (3 r^2 + L^2)/12
///   capsule    a cylinder and two half spheres, in the ratio of their volumes.  The centre of mass of a half
///              sphere is 3/8 r from its flat face, and its moment across about it is (2/5 - 9/64) r^2; moved
///              to the capsule's middle, by L/2 + 3/8 r, both half spheres have 2/5 r^2 + L^2/4 + 3/8 L r
///              per unit of mass.
Vec3 unit_moments(const BoneSpec& spec) {
  const double r = spec.radius_m, L = spec.length_m, r2 = r * r;
  if (spec.shape == BoneShape::kSphere) return Vec3::Constant(0.4 * r2);
  if (spec.shape == BoneShape::kBox) {
    const Vec3 s = spec.size_m.cwiseAbs2();
    return (s.sum() - s.array()) / 12.0;
  }
  const double across = (3.0 * r2 + L * L) / 12.0, along = r2 / 2.0;
  if (spec.shape == BoneShape::kCylinder) return {across, across, along};
  const double rod = L / (L + 4.0 / 3.0 * r), caps = 1.0 - rod,
               both = rod * across + caps * (0.4 * r2 + L * L / 4.0 + 0.375 * L * r);
  return {both, both, rod * along + caps * 0.4 * r2};
}

}  // namespace

double bone_volume(const BoneSpec& spec) {
  const double r = spec.radius_m, ball = 4.0 / 3.0 * pi * r * r * r, rod = pi * r * r * spec.length_m;
  if (spec.shape == BoneShape::kSphere) return ball;
  if (spec.shape == BoneShape::kBox) return spec.size_m.prod();
  if (spec.shape == BoneShape::kCylinder) return rod;
  return spec.shape == BoneShape::kCapsule ? rod + ball : 0.0;
}

BoneInertia bone_inertia(const BoneSpec& spec) {
  const double volume = bone_volume(spec);
  if (spec.shape && !(volume > 0.0))
    fail("bone \"{}\": shape = \"{}\" has a volume of {} m^3; its sizes must be positive", spec.name,
         name_of(*spec.shape), volume);
  BoneInertia out{spec.mass_kg > 0.0 ? spec.mass_kg : spec.density_kg_m3 * volume, spec.inertia_kg_m2};
  if (out.principal.isZero(0.0) && spec.shape) out.principal = out.mass * unit_moments(spec);
  dynamics::check_inertia(out.mass, out.principal, fmt::format("bone \"{}\"", spec.name).c_str());
  return out;
}

bool inside_bone(const BoneSpec& spec, const Vec3& p) {
  const double some = 1.0 + 1e-9, r = spec.radius_m * some, half = 0.5 * spec.length_m;
  if (spec.shape == BoneShape::kSphere) return p.norm() <= r;
  if (spec.shape == BoneShape::kBox) return (p.cwiseAbs().array() <= 0.5 * some * spec.size_m.array()).all();
  if (spec.shape == BoneShape::kCylinder) return p.head<2>().norm() <= r && std::abs(p.z()) <= half * some;
  return spec.shape == BoneShape::kCapsule &&
         (p - Vec3(0.0, 0.0, std::clamp(p.z(), -half, half))).norm() <= r;
}

TriMesh bone_surface(const BoneSpec& spec) {
  if (spec.shape == BoneShape::kSphere) return mesh::sphere(spec.radius_m, 8);
  if (spec.shape == BoneShape::kBox) return mesh::box_surface(spec.size_m, {1, 1, 1});
  if (spec.shape == BoneShape::kCylinder)
    return mesh::cylinder_surface(spec.radius_m, spec.length_m, 0.3 * spec.radius_m);
  return spec.shape == BoneShape::kCapsule ? capsule_surface(spec.radius_m, spec.length_m) : TriMesh{};
}

}  // namespace palpate::bones
