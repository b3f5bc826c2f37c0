#pragma once
#include "palpate/dynamics/spec.h"

namespace palpate::integrate {

/// @throws Error naming the key of the `[integrator]` table, its value and what to write instead.
void check_adaptive(const IntegratorSpec& spec, int highest_order, double tightest_rtol);
/// The smallest rtol that the method takes with these settings.
void check_tightest(const IntegratorSpec& spec, double tightest_rtol);
Range order_range(int highest_order);  ///< of max_order
void check_fixed_step(const IntegratorSpec& spec);
void check_static(const IntegratorSpec& spec);
/// Checks the settings that Newton's method of the fixed-step implicit methods reads.
void check_newton(const IntegratorSpec& spec);
void check_spectral_radius(const IntegratorSpec& spec);

}  // namespace palpate::integrate
