#include <algorithm>
#include <cmath>

#include "cases.h"
#include "palpate/integrate/integrators.h"
#include "vibrating_bar.h"

// Problem: free vibration of a clamped bar by fixed steps of every method that supports them. The motion and
// its exact answer are in vibrating_bar.h.
//
// Measured: the observed order against the order claimed by the registry, +/- 0.1. An order is observed only
// in the asymptotic range of the method for the modes involved. The motion starts at rest in the three lowest
// modes and runs for T, half a period of the first. With w the third, the error of one step relative to the
// mode is C (w H)^{p+1}, of the run C (w H)^p w T:
//     order 1:      w^2 H T/2 <= 0.2      (damping of the amplitude, e^{-w^2 H T/2})
//     order 2:      w H <= 0.3 and w^3 H^2 T/12 <= 0.1      (phase)
//     order p >= 3: w H <= 0.1, which implies w^{p+1} H^p T/12 <= 0.1.
// Tables with a small leading or a large next term show their order later: the coarsest step is a quarter of
// this bound for order 2 (sdirk212), and w H = 0.05 for order 3 (esdirk325). Explicit methods also satisfy a
// limit for the highest mode: w_max H <= 0.5 for order 1 to 3, since order 2 has no stability limit on the
// imaginary axis but grows by (w_max H)^4/8 per step, which must not amplify rounding to a visible level; 1.5
// for higher order, whose error would otherwise start at rounding. Steps shrink by 2 (order <= 2) or 1.5, so
// that the error at the finest step remains above rounding. Nonlinear and linear equations are solved to
// rtol = newton_rtol = 1e-9: the problem is linear, and the first correction is exact except for rounding.

namespace palpate::validation {
namespace {

double coarsest_step(const dynamics::StepperTraits& traits, const VibratingBar& bar, double T) {
  const double w = bar.omega[VibratingBar::kModes - 1];
  const double accurate = traits.order == 1   ? 0.4 / (w * w * T)
                          : traits.order == 2 ? 0.25 * std::min(0.3 / w, std::sqrt(1.2 / (w * w * w * T)))
                          : traits.order == 3 ? 0.05 / w
                                              : 0.1 / w;
  return traits.stability == dynamics::Stability::kExplicit
             ? std::min(accurate, (traits.order <= 3 ? 0.5 : 1.5) / bar.highest_omega)
             : accurate;
}

Measurement order_of_steps(const VibratingBar& bar, const dynamics::StepperEntry& entry,
                           const std::string& fault) {
  const double T = 0.5 * bar.period(), ratio = entry.traits.order <= 2 ? 2.0 : 1.5;
  IntegratorSpec spec;
  spec.name = entry.name;
  spec.fixed_step = true;
  spec.rtol = spec.newton_rtol = 1e-9;
  std::vector<double> steps, errors;
  for (int k = 0; k < 4; ++k) {
    spec.step_s = coarsest_step(entry.traits, bar, T) / std::pow(ratio, k);
    steps.push_back(spec.step_s);
    errors.push_back(vibration_error(bar, spec, {.T = T}, fault));
  }
  const double order = entry.traits.order;
  return {
      .quantity = entry.name + ": error at the finest step",
      .computed = errors.back(),
      .error = errors.back(),
      .bar = 0.05,
      .order = validation::fitted_order(steps, errors),
      .order_low = order - 0.1,
      .order_high = order + 0.1,
      .note = fmt::format("order in the step, 4 steps from {:.2g} to {:.2g} s", steps.front(), steps.back()),
      .refinement = {"step [s]", steps, errors}};
}

std::vector<Measurement> run(const std::string& fault) {
  using dynamics::StepControl;
  const VibratingBar bar;
  std::vector<Measurement> out;
  const auto is_wanted = [&](const dynamics::StepperEntry& entry) {
    if (!fault.empty()) return entry.name == "rk4" || entry.name == "implicit-midpoint";  // They detect it.
    return entry.traits.stability != dynamics::Stability::kStatic &&
           entry.traits.control != StepControl::kAdaptive;
  };
  for (const auto& entry : integrate::stepper_registry())
    if (is_wanted(entry)) out.push_back(order_of_steps(bar, entry, fault));
  if (!fault.empty()) return out;
  IntegratorSpec spec;
  spec.rtol = 1e-4;
  const double e = vibration_error(bar, spec, {.T = 0.5 * bar.period(), .amplitude = 1e-5}, fault);
  out.push_back({.quantity = "corotational body at amplitude 1e-5 m, cvode-bdf: error",
                 .computed = e,
                 .error = e,
                 .bar = 1e-3,
                 .note = "rtol 1e-4; the nonlinearity is 1e-5"});
  return out;
}

}  // namespace

ValidationCase free_vibration() {
  return {.name = "free-vibration",
          .section = "D",
          .summary =
              "free vibration of a clamped bar against the modes of its K and M: order of every integrator "
              "in its step",
          .why =
              "the reference is exact in time and contributes no error; eigenvectors by a dense solver that "
              "no integrator uses",
          .run = run,
          .faults = {{"force-off-by-one-percent", "rk4: error at the finest step"},
                     {"first-order-rule", "implicit-midpoint: error at the finest step"}}};
}

}  // namespace palpate::validation
