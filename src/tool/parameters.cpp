#include "parameters.h"

#include <cmath>

#include "palpate/core/error.h"

namespace palpate::tool {
namespace {

void check_not_negative(double value, const char* key) {
  if (!(value >= 0.0) || !std::isfinite(value)) fail("tool: {} = {} must be a number that is not negative", key, value);
}

void check_finite(const Vec3& value, const char* key) {
  if (!value.allFinite()) fail("tool: {} = [{}, {}, {}] must be finite", key, value.x(), value.y(), value.z());
}

}  // namespace

// I1 = int (y^2 + z^2) dm and so on: no principal moment can exceed the sum of the other two.
void check_inertia(double mass, const Vec3& inertia, const char* where) {
  if (!(mass > 0.0) || !std::isfinite(mass)) fail("{}: mass_kg = {} must be positive", where, mass);
  const double largest = inertia.maxCoeff();
  if (!inertia.allFinite() || !(inertia.minCoeff() > 0.0))
    fail("{}: inertia_kg_m2 = [{}, {}, {}] must have three positive entries (or three zeros, for a solid sphere's)", where, inertia.x(), inertia.y(),
         inertia.z());
  if (largest > (inertia.sum() - largest) * (1.0 + 1e-9))
    fail("{}: inertia_kg_m2 = [{}, {}, {}] belongs to no body: each must be at most the sum of the other two", where, inertia.x(), inertia.y(),
         inertia.z());
}

RigidParameters rigid_parameters(const ToolSpec& spec, const Vec3& gravity) {
  RigidParameters p{spec.mass_kg, spec.inertia_kg_m2, spec.gravity ? gravity : Vec3(Vec3::Zero())};
  if (p.inertia.isZero(0.0)) {
    if (!(spec.radius_m > 0.0) || !std::isfinite(spec.radius_m))
      fail("tool: radius_m = {} must be positive; it gives the inertia where inertia_kg_m2 is left out", spec.radius_m);
    p.inertia.setConstant(0.4 * p.mass * spec.radius_m * spec.radius_m);
  }
  check_inertia(p.mass, p.inertia, "tool");
  check_not_negative(spec.coupling_stiffness_n_m, "coupling_stiffness_n_m");
  check_not_negative(spec.coupling_damping_n_s_m, "coupling_damping_n_s_m");
  check_not_negative(spec.coupling_rotational_stiffness_n_m_rad, "coupling_rotational_stiffness_n_m_rad");
  check_not_negative(spec.coupling_rotational_damping_n_m_s_rad, "coupling_rotational_damping_n_m_s_rad");
  if (!(spec.tick_s > 0.0) || !std::isfinite(spec.tick_s)) fail("tool: tick_s = {} must be positive", spec.tick_s);
  check_finite(spec.position_m, "position_m");
  check_finite(spec.rotation_vector_rad, "rotation_vector_rad");
  check_finite(p.gravity, "gravity");
  return p;
}

}  // namespace palpate::tool
