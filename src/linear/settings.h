#pragma once
#include "palpate/dynamics/spec.h"

namespace palpate::linear {

/// Smallest useful relative tolerance: below it |r| / |b| is the rounding error of sums in double precision.
constexpr double kTightest = 1e-15;

/// Checks the settings that iterative solvers read (linear_rtol, threads).
/// @throws Error with the key, its value and the range
void check_linear_rtol(const char* solver, const IntegratorSpec& spec);

}  // namespace palpate::linear
