#include "linear/settings.h"

#include "palpate/core/error.h"

namespace palpate::linear {

void check_linear_rtol(const char* solver, const IntegratorSpec& spec) {
  if (!(spec.linear_rtol >= 1e-15 && spec.linear_rtol <= 0.1))
    fail("linear solver \"{}\": linear_rtol = {} must lie in [1e-15, 0.1]; 1e-8 is usual", solver,
         spec.linear_rtol);
  if (spec.threads < 1 || spec.threads > 64)
    fail("linear solver \"{}\": threads = {} must lie in [1, 64]", solver, spec.threads);
}

}  // namespace palpate::linear
