#include "linear/settings.h"

#include "palpate/core/error.h"

namespace palpate::linear {

void check_linear_rtol(const char* solver, const IntegratorSpec& spec) {
  if (!IntegratorRanges::linear_rtol.holds(spec.linear_rtol))
    fail("linear solver \"{}\": linear_rtol = {} {}", solver, spec.linear_rtol,
         IntegratorRanges::linear_rtol.demand());
  if (!IntegratorRanges::threads.holds(spec.threads))
    fail("linear solver \"{}\": threads = {} {}", solver, spec.threads, IntegratorRanges::threads.demand());
}

}  // namespace palpate::linear
