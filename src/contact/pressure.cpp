#include "palpate/contact/pressure.h"

#include <algorithm>
#include <cmath>

#include "contact/methods.h"
#include "palpate/core/error.h"
#include "palpate/core/registry.h"

namespace palpate::contact {
namespace {

void require(const ContactSpec& spec, const char* key, double value, const Range& range) {
  if (!range.holds(value))
    fail("contact \"{}\" with \"{}\": {} = {} {}", spec.first, spec.second, key, value, range.demand());
}

}  // namespace

PressureLaw pressure_law(const ContactSpec& spec) {
  using Ranges = ContactRanges;
  require(spec, "stiffness_pa_m", spec.stiffness_pa_m, Ranges::stiffness_pa_m);
  require(spec, "stiffness_n_m", spec.stiffness_n_m, Ranges::stiffness_n_m);
  require(spec, "damping_pa_s_m", spec.damping_pa_s_m, Ranges::damping_pa_s_m);
  require(spec, "damping_n_s_m", spec.damping_n_s_m, Ranges::damping_n_s_m);
  require(spec, "hunt_crossley_s_m", spec.hunt_crossley_s_m, Ranges::hunt_crossley_s_m);
  require(spec, "friction", spec.friction, Ranges::friction);
  require(spec, "friction_regularisation_m_s", spec.friction_regularisation_m_s,
          Ranges::friction_regularisation_m_s);
  require(spec, "onset_width_m", spec.onset_width_m, Ranges::onset_width_m);
  const bool per_point = spec.spring == "per_point";
  if (!per_point && spec.spring != "per_area")
    fail("contact \"{}\" with \"{}\": unknown spring \"{}\"{}", spec.first, spec.second, spec.spring,
         suggestion(spec.spring, names(spring_registry())));
  const bool secant = spec.friction_tangent == FrictionTangent::kSecant;
  PressureLaw law{PressureLaw::Kind::kKelvinVoigt,
                  per_point ? spec.stiffness_n_m : spec.stiffness_pa_m,
                  per_point ? spec.damping_n_s_m : spec.damping_pa_s_m,
                  spec.onset_width_m,
                  spec.friction,
                  spec.friction_regularisation_m_s > 0.0 ? spec.friction_regularisation_m_s
                                                         : PressureLaw().regularisation,
                  spec.friction_retardation_s,
                  secant || spec.friction_tangent == FrictionTangent::kSymmetric,
                  per_point,
                  secant};
  if (spec.law == "kelvin_voigt") return law;
  if (spec.law != "hunt_crossley")
    fail("contact \"{}\" with \"{}\": unknown law \"{}\"{}", spec.first, spec.second, spec.law,
         suggestion(spec.law, names(law_registry())));
  law.kind = PressureLaw::Kind::kHuntCrossley;
  law.d = spec.hunt_crossley_s_m;
  return law;
}

// p > 0 where delta > 0 and
//   kelvin_voigt   k delta + d delta' > 0         that is  gap + (d/k) rate < 0
//   hunt_crossley  1 + 3/2 c delta' > 0           that is  3/2 c rate - 1 < 0, times |gap| for equal units
// so that the larger of the gap and this expression is negative exactly there. (For laws without an onset:
// with one the force has no kink to locate.)
double pressing(const PressureLaw& law, double gap, double gap_rate) {
  if (law.d == 0.0) return gap;
  return std::max(gap, law.kind == PressureLaw::Kind::kKelvinVoigt
                           ? gap + law.d / law.k * gap_rate
                           : std::abs(gap) * (1.5 * law.d * gap_rate - 1.0));
}

Pressure pressure(const ContactSpec& law, double gap, double gap_rate) {
  return pressure(pressure_law(law), gap, gap_rate);
}

}  // namespace palpate::contact
