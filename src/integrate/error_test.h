#pragma once
#include "palpate/dynamics/spec.h"

namespace palpate::integrate {

// What rtol means.  An error test bounds the error of one step, by an estimate of some order; what a user
// asks for is the error over a given time.  With an estimate C h^(m+1) held to T, h ~ T^(1/(m+1)), and a
// solution of order p that errs by h^p over that time errs by T^(p/(m+1)).  The test is therefore held to
//     T = factor rtol^((m+1)/p),
// so that with every method a tenth of rtol buys a tenth of the error, and rtol is about the error that a
// radian of an undamped motion adds, in the weighted norm (error_weights.h):
//     backward differences    m = p = k, the highest order allowed:   T = rtol^((k+1)/k).  C = 1/(k+1), and
//                             the factor is 1 within 1.3
//     Adams-Moulton           its order rises with the tolerance up to 12, and the error falls as T by
//                             itself; but it adds up over some ten steps a radian, each of which may err by
//                             T = rtol/10
//     Runge-Kutta pair p(p^)  m = min(p, p^): a factor, at most 1, times rtol for the usual p^ = p - 1, by
//                             the pair's own coefficients (ark_calibration.cpp).  Three pairs have m = p on
//                             linear motions and p - 1 on others.  Half-way between, m = p - 1/2, the error
//                             falls as T^((p+1/2)/(p+1)) on the former and T^((p+1/2)/p) on the latter: 0.90
//                             and 1.13 for p = 4, 0.92 and 1.10 for p = 5.
// A request whose T lies below kTightestErrorTest (tuning.h) is refused, not met half-way.

double error_test_rtol_of_bdf(const IntegratorSpec& spec);
double error_test_rtol_of_adams(const IntegratorSpec& spec);
double error_test_rtol_of_ark(const IntegratorSpec& spec);
double error_test_rtol_of_mri(const IntegratorSpec& spec);  ///< of the fast side

double tightest_rtol_of_bdf(const IntegratorSpec& spec);
double tightest_rtol_of_adams(const IntegratorSpec& spec);
double tightest_rtol_of_ark(const IntegratorSpec& spec);
double tightest_rtol_of_mri(const IntegratorSpec& spec);

/// Values of the key `rtol` from `tightest` on.
Range rtol_range(double tightest);

}  // namespace palpate::integrate
