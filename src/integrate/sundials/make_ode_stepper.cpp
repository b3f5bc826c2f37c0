#include "integrate/ode_problem.h"
#include "integrate/sundials/make_adapter.h"
#include "palpate/core/error.h"

namespace palpate::integrate {

std::unique_ptr<dynamics::Stepper> make_ode_stepper(std::unique_ptr<OdeProblem> problem,
                                                    const IntegratorSpec& spec) {
  if (spec.name == "ida") return sun::make_ida(std::move(problem), spec);
  if (spec.name.starts_with("cvode-")) return sun::make_cvode(std::move(problem), spec);
  if (spec.name.starts_with("ark-mri-")) return sun::make_mri(std::move(problem), spec);
  if (spec.name.starts_with("ark-")) return sun::make_ark(std::move(problem), spec);
  fail("integrator \"{}\" cannot solve y' = f(t, y)", spec.name);
}

}  // namespace palpate::integrate
