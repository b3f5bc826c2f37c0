#include "parameters.h"

#include <cmath>

#include "palpate/core/error.h"

namespace palpate::tool {
namespace {

void check_not_negative(double value, const char* key) {
  if (!(value >= 0.0) || !std::isfinite(value))
    fail("tool: {} = {} must be a number that is not negative", key, value);
}

void check_finite(const Vec3& value, const char* key) {
  if (!value.allFinite())
    fail("tool: {} = [{}, {}, {}] must be finite", key, value.x(), value.y(), value.z());
}

}  // namespace

RigidParameters rigid_parameters(const ToolSpec& spec, const Vec3& gravity) {
  RigidParameters p{spec.mass_kg, spec.inertia_kg_m2, spec.gravity ? gravity : Vec3(Vec3::Zero())};
  if (p.inertia.isZero(0.0)) {
    if (!(spec.radius_m > 0.0) || !std::isfinite(spec.radius_m))
      fail("tool: radius_m = {} must be positive; it gives the inertia where inertia_kg_m2 is left out",
           spec.radius_m);
    p.inertia.setConstant(0.4 * p.mass * spec.radius_m * spec.radius_m);
  }
  check_inertia(p.mass, p.inertia, "tool");
  check_not_negative(spec.coupling_stiffness_n_m, "coupling_stiffness_n_m");
  check_not_negative(spec.coupling_damping_n_s_m, "coupling_damping_n_s_m");
  check_not_negative(spec.coupling_rotational_stiffness_n_m_rad, "coupling_rotational_stiffness_n_m_rad");
  check_not_negative(spec.coupling_rotational_damping_n_m_s_rad, "coupling_rotational_damping_n_m_s_rad");
  if (!(spec.tick_s > 0.0) || !std::isfinite(spec.tick_s))
    fail("tool: tick_s = {} must be positive", spec.tick_s);
  check_finite(spec.position_m, "position_m");
  check_finite(spec.rotation_vector_rad, "rotation_vector_rad");
  check_finite(p.gravity, "gravity");
  return p;
}

}  // namespace palpate::tool
