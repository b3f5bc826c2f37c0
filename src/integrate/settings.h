#pragma once
#include "palpate/dynamics/spec.h"

namespace palpate::integrate {

/// Checks the settings of a method with error control. @throws Error with the key of the `[integrator]`
/// table, its value and a valid range, as do all checks below
void check_adaptive(const IntegratorSpec& spec, int highest_order, double tightest_rtol);
/// Checks that rtol is not below the smallest one that the method accepts with these settings.
void check_tightest(const IntegratorSpec& spec, double tightest_rtol);
Range order_range(int highest_order);  ///< Range of max_order.
/// Checks the settings of a method with fixed steps.
void check_fixed_step(const IntegratorSpec& spec);
/// Checks the settings of quasi-static equilibrium.
void check_static(const IntegratorSpec& spec);
/// Checks the settings of Newton's method in fixed-step implicit methods.
void check_newton(const IntegratorSpec& spec);
/// Checks the spectral radius of generalized-alpha.
void check_spectral_radius(const IntegratorSpec& spec);

}  // namespace palpate::integrate
