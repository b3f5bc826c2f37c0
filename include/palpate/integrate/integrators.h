#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/dynamics/stepper.h"

namespace palpate::integrate {

/// Every integrator of soft bodies, by the name used in scenes, on the command line and in reports.
const dynamics::StepperRegistry& stepper_registry();

/// The integrator that the spec names, with linear_solver_of(spec).  @throws Error for unknown names and bad
/// settings.
std::unique_ptr<dynamics::Stepper> make_stepper(dynamics::System& system, dynamics::State& state,
                                                const IntegratorSpec& spec);
/// The linear solver that the spec names, or else the method's own, where factor_kept_steps > 1 cholmod;
/// empty where the method is explicit.  @throws Error for an unknown integrator
std::string linear_solver_of(const IntegratorSpec& spec);
/// The tolerance of the method's own error test with this spec (StepperEntry::error_test_rtol); empty where
/// steps are fixed.  Of a multi-rate method that of the fast side.  @throws Error for an unknown integrator
std::optional<double> error_test_rtol_of(const IntegratorSpec& spec);
/// The linear solver of that name with an LU behind it: takes unsymmetric and indefinite matrices too, and
/// right-hand sides that an iteration does not answer.  For those whose matrices are usually positive
/// definite and who have no step to shorten.
std::unique_ptr<dynamics::LinearSolver> make_robust_linear_solver(const std::string& name,
                                                                  const IntegratorSpec& spec = {});

/// The libraries locked in here, name and version, for a result's provenance.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace palpate::integrate
