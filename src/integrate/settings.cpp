#include "integrate/settings.h"

#include <cmath>

#include "palpate/core/error.h"

namespace palpate::integrate {
namespace {

void check_positive(const IntegratorSpec& spec, const char* key, double value, const char* remedy) {
  if (!(value > 0.0) || !std::isfinite(value))
    fail("integrator \"{}\": {} = {} must be positive and finite; {}", spec.name, key, value, remedy);
}

void check_max_steps(const IntegratorSpec& spec) {
  if (spec.max_steps < 1)
    fail(
        "integrator \"{}\": max_steps = {} must be at least 1; it bounds the internal steps between two "
        "outputs",
        spec.name, spec.max_steps);
}

}  // namespace

void check_adaptive(const IntegratorSpec& spec, int highest_order) {
  check_positive(spec, "rtol", spec.rtol, "1e-3 is usual");
  if (spec.rtol > 0.1)
    fail("integrator \"{}\": rtol = {} must be at most 0.1; 1e-3 is usual", spec.name, spec.rtol);
  check_positive(spec, "atol_q", spec.atol_q, "0.01 is usual");
  check_positive(spec, "atol_u", spec.atol_u, "0.1 is usual");
  if (spec.max_order < 0 || spec.max_order > highest_order)
    fail("integrator \"{}\": max_order = {} must lie in [0, {}]; 0 leaves it to the method", spec.name,
         spec.max_order, highest_order);
  check_max_steps(spec);
  if (spec.fixed_step)
    fail(
        "integrator \"{}\": fixed_step = true, but this method chooses its steps by error control; leave it "
        "out, or take a method that can do both (palpate list integrators)",
        spec.name);
}

void check_fixed_step(const IntegratorSpec& spec) {
  check_positive(spec, "step_s", spec.step_s, "1e-3 is usual");
  check_max_steps(spec);
}

void check_static(const IntegratorSpec& spec) {
  check_positive(spec, "newton_rtol", spec.newton_rtol, "1e-8 is usual");
}

void check_newton(const IntegratorSpec& spec) {
  if (!(spec.newton_rtol >= 1e-14 && spec.newton_rtol <= 0.1))
    fail("integrator \"{}\": newton_rtol = {} must lie in [1e-14, 0.1]; 1e-8 is usual", spec.name,
         spec.newton_rtol);
  check_positive(spec, "atol_q", spec.atol_q, "0.01 is usual");
  check_positive(spec, "atol_u", spec.atol_u, "0.1 is usual");
  if (spec.factor_kept_steps < 1)
    fail("integrator \"{}\": factor_kept_steps = {} must be at least 1; 1 is full Newton", spec.name,
         spec.factor_kept_steps);
}

void check_spectral_radius(const IntegratorSpec& spec) {
  if (!(spec.spectral_radius >= 0.0 && spec.spectral_radius <= 1.0))
    fail("integrator \"{}\": spectral_radius = {} must lie in [0, 1]; 1 damps nothing, 0 the most", spec.name,
         spec.spectral_radius);
}

}  // namespace palpate::integrate
