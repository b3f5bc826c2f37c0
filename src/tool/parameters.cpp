#include "parameters.h"

#include "palpate/core/error.h"

namespace palpate::tool {
namespace {

void check_range(const char* table, const char* key, double value, const Range& range) {
  if (!range.holds(value)) fail("{}: {} = {} {}", table, key, value, range.demand());
}

void check_finite(const Vec3& value, const char* key) {
  if (!value.allFinite())
    fail("tool: {} = [{}, {}, {}] must be finite", key, value.x(), value.y(), value.z());
}

}  // namespace

RigidParameters rigid_parameters(const ToolSpec& spec, const Vec3& gravity) {
  RigidParameters p{spec.mass_kg, spec.inertia_kg_m2, spec.gravity ? gravity : Vec3(Vec3::Zero())};
  if (p.inertia.isZero(0.0)) {
    if (!ToolRanges::radius_m.holds(spec.radius_m))
      fail("tool: radius_m = {} {}; it determines the inertia if inertia_kg_m2 is omitted", spec.radius_m,
           ToolRanges::radius_m.demand());
    p.inertia.setConstant(0.4 * p.mass * spec.radius_m * spec.radius_m);
  }
  check_inertia(p.mass, p.inertia, "tool");
  const VirtualCouplingSpec& c = spec.coupling;
  const auto check_coupling = [](const char* key, double value) {
    check_range("tool.coupling", key, value, ToolRanges::coupling);
  };
  check_coupling("stiffness_n_m", c.stiffness_n_m);
  check_coupling("damping_n_s_m", c.damping_n_s_m);
  check_coupling("rotational_stiffness_n_m_rad", c.rotational_stiffness_n_m_rad);
  check_coupling("rotational_damping_n_m_s_rad", c.rotational_damping_n_m_s_rad);
  check_range("tool", "tick_s", spec.tick_s, ToolRanges::tick_s);
  check_finite(spec.position_m, "position_m");
  check_finite(spec.rotation_vector_rad, "rotation_vector_rad");
  check_finite(p.gravity, "gravity");
  return p;
}

}  // namespace palpate::tool
