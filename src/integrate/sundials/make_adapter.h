#pragma once
#include "integrate/ode_problem.h"
#include "integrate/sundials/hidden.h"
#include "palpate/dynamics/spec.h"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// Factories of the adapters, for any OdeProblem; spec.name selects the method.
std::unique_ptr<dynamics::Stepper> make_cvode(std::unique_ptr<OdeProblem> problem,
                                              const IntegratorSpec& spec);
std::unique_ptr<dynamics::Stepper> make_ark(std::unique_ptr<OdeProblem> problem, const IntegratorSpec& spec);
std::unique_ptr<dynamics::Stepper> make_mri(std::unique_ptr<OdeProblem> problem, const IntegratorSpec& spec);
std::unique_ptr<dynamics::Stepper> make_ida(std::unique_ptr<OdeProblem> problem, const IntegratorSpec& spec);

}  // namespace sun
}  // namespace palpate::integrate
