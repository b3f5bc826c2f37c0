#include "integrate/settings.h"

#include "palpate/core/error.h"

namespace palpate::integrate {
namespace {

using Ranges = IntegratorRanges;

void check(const IntegratorSpec& spec, const char* key, double value, const Range& range) {
  if (!range.holds(value)) fail("integrator \"{}\": {} = {} {}", spec.name, key, value, range.demand());
}

void check_atol(const IntegratorSpec& spec) {
  check(spec, "atol_q", spec.atol_q, Ranges::atol_q);
  check(spec, "atol_u", spec.atol_u, Ranges::atol_u);
}

}  // namespace

Range order_range(int highest_order) { return Range::closed(0, highest_order, Ranges::max_order.remedy); }

void check_tightest(const IntegratorSpec& spec, double tightest_rtol) {
  if (spec.rtol >= tightest_rtol) return;
  fail(
      "integrator \"{}\": rtol = {} is below {}, the smallest value that this method can reach{}; below it, "
      "rounding dominates",
      spec.name, spec.rtol, tightest_rtol,
      spec.max_order > 0 ? fmt::format(" with max_order = {}", spec.max_order) : "");
}

void check_adaptive(const IntegratorSpec& spec, int highest_order, double tightest_rtol) {
  check(spec, "rtol", spec.rtol, Ranges::rtol);
  check_tightest(spec, tightest_rtol);
  check_atol(spec);
  check(spec, "max_order", spec.max_order, order_range(highest_order));
  check(spec, "max_steps", spec.max_steps, Ranges::max_steps);
  if (spec.fixed_step)
    fail(
        "integrator \"{}\": fixed_step = true, but this method always chooses its steps by error control; "
        "remove fixed_step, or use a method that supports both (palpate list integrators)",
        spec.name);
}

void check_fixed_step(const IntegratorSpec& spec) {
  check(spec, "step_s", spec.step_s, Ranges::step_s);
  check(spec, "max_steps", spec.max_steps, Ranges::max_steps);
}

void check_static(const IntegratorSpec& spec) {
  check(spec, "newton_rtol", spec.newton_rtol, Ranges::newton_rtol);
}

void check_newton(const IntegratorSpec& spec) {
  check(spec, "newton_rtol", spec.newton_rtol, Ranges::newton_rtol);
  check_atol(spec);
  check(spec, "factor_kept_steps", spec.factor_kept_steps, Ranges::factor_kept_steps);
}

void check_spectral_radius(const IntegratorSpec& spec) {
  check(spec, "spectral_radius", spec.spectral_radius, Ranges::spectral_radius);
}

}  // namespace palpate::integrate
