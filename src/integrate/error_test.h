#pragma once
#include "palpate/dynamics/spec.h"

namespace palpate::integrate {

// Meaning of rtol. An error test bounds the error of one step, by an estimate of some order; a user specifies
// the error over a given time. With an estimate C h^(m+1) kept at the tolerance T, h ~ T^(1/(m+1)), and a
// solution of order p, whose error over that time is ~ h^p, has an error ~ T^(p/(m+1)). The test therefore
// uses
//     T = factor rtol^((m+1)/p),
// so that with every method a tenth of rtol yields a tenth of the error, and rtol is approximately the error
// added per radian of an undamped oscillation, in the weighted norm (error_weights.h):
//     backward differences    m = p = k, the highest order allowed:   T = rtol^((k+1)/k).  C = 1/(k+1), and
//                             the factor is 1 within 1.3
//     Adams-Moulton           its order rises with the tolerance up to 12, and the error falls as T; but it
//                             adds up over some ten steps per radian, each of which may err by T = rtol/10
//     Runge-Kutta pair p(p^)  m = min(p, p^): a factor, at most 1, times rtol for the usual p^ = p - 1, from
//                             the pair's coefficients (ark_calibration.cpp).  Three pairs have m = p on
//                             linear motions and p - 1 on others.  Half-way between, m = p - 1/2, the error
//                             falls as T^((p+1/2)/(p+1)) on the former and T^((p+1/2)/p) on the latter: 0.90
//                             and 1.13 for p = 4, 0.92 and 1.10 for p = 5.
// An rtol whose T is below kTightestErrorTest (tuning.h) is rejected.

/// Returns the tolerance T of the error test for spec.rtol, by family of methods.
double error_test_rtol_of_bdf(const IntegratorSpec& spec);
double error_test_rtol_of_adams(const IntegratorSpec& spec);
double error_test_rtol_of_ark(const IntegratorSpec& spec);
double error_test_rtol_of_mri(const IntegratorSpec& spec);  ///< Tolerance of the fast side.

/// Returns the smallest rtol that is accepted with these settings, by family of methods.
double tightest_rtol_of_bdf(const IntegratorSpec& spec);
double tightest_rtol_of_adams(const IntegratorSpec& spec);
double tightest_rtol_of_ark(const IntegratorSpec& spec);
double tightest_rtol_of_mri(const IntegratorSpec& spec);

/// Returns the valid range of the key `rtol`, from `tightest` on.
Range rtol_range(double tightest);

}  // namespace palpate::integrate
