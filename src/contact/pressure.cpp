#include "contact/pressure.h"

#include <cmath>

#include "palpate/core/error.h"

namespace palpate::contact {
namespace {

void require(const ContactSpec& spec, bool ok, const char* key, double value, const char* remedy) {
  if (!ok) fail("contact \"{}\" with \"{}\": {} = {} {}", spec.first, spec.second, key, value, remedy);
}

}  // namespace

PressureLaw pressure_law(const ContactSpec& spec) {
  require(spec, spec.stiffness_pa_m > 0 && std::isfinite(spec.stiffness_pa_m), "stiffness_pa_m", spec.stiffness_pa_m, "must be positive");
  require(spec, spec.damping_pa_s_m >= 0 && std::isfinite(spec.damping_pa_s_m), "damping_pa_s_m", spec.damping_pa_s_m, "must not be negative");
  require(spec, spec.hunt_crossley_s_m >= 0 && std::isfinite(spec.hunt_crossley_s_m), "hunt_crossley_s_m", spec.hunt_crossley_s_m,
          "must not be negative");
  require(spec, spec.friction >= 0 && std::isfinite(spec.friction), "friction", spec.friction, "must not be negative");
  require(spec, spec.friction_regularisation_m_s > 0 && std::isfinite(spec.friction_regularisation_m_s), "friction_regularisation_m_s",
          spec.friction_regularisation_m_s, "must be positive: below this sliding speed friction is viscous");
  PressureLaw law{PressureLaw::Kind::kKelvinVoigt, spec.stiffness_pa_m, spec.damping_pa_s_m, spec.friction, spec.friction_regularisation_m_s};
  if (spec.law == "kelvin_voigt") return law;
  if (spec.law != "hunt_crossley")
    fail("contact \"{}\" with \"{}\": unknown law \"{}\"{}", spec.first, spec.second, spec.law, suggestion(spec.law, {"kelvin_voigt", "hunt_crossley"}));
  law.kind = PressureLaw::Kind::kHuntCrossley;
  law.d = spec.hunt_crossley_s_m;
  return law;
}

// With delta = -gap, delta' = -gap_rate, so dp/dgap = -dp/ddelta and dp/drate = -dp/ddelta':
//   kelvin_voigt   dp/ddelta = k                    dp/ddelta' = d
//   hunt_crossley  dp/ddelta = k (1 + 3/2 c delta') dp/ddelta' = 3/2 k c delta
// Where the formula gives tension the pressure and its derivatives are zero: a contact never pulls.
Pressure pressure(const PressureLaw& law, double gap, double gap_rate) {
  const double depth = -gap, rate = -gap_rate;
  if (!(depth > 0.0)) return {0.0, 0.0, 0.0, 0.0};
  const double energy = 0.5 * law.k * depth * depth;
  if (law.kind == PressureLaw::Kind::kKelvinVoigt) {
    const double p = law.k * depth + law.d * rate;
    return p > 0.0 ? Pressure{p, -law.k, -law.d, energy} : Pressure{0.0, 0.0, 0.0, energy};
  }
  const double factor = 1.0 + 1.5 * law.d * rate;
  return factor > 0.0 ? Pressure{law.k * depth * factor, -law.k * factor, -1.5 * law.k * law.d * depth, energy} : Pressure{0.0, 0.0, 0.0, energy};
}

Pressure pressure(const ContactSpec& law, double gap, double gap_rate) { return pressure(pressure_law(law), gap, gap_rate); }

}  // namespace palpate::contact
