#pragma once
#include "palpate/dynamics/spec.h"

namespace palpate::linear {

/// Below this |r| / |b| is rounding of sums in double precision.
constexpr double kTightest = 1e-15;

/// Settings that iterative solvers read.  @throws Error naming the key, its value and the range
void check_linear_rtol(const char* solver, const IntegratorSpec& spec);

}  // namespace palpate::linear
