#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/dynamics/stepper.h"

namespace palpate::integrate {

/// Returns all integrators of soft bodies, by the names used in scenes, on the command line and in reports.
const dynamics::StepperRegistry& stepper_registry();

/// Makes the integrator that the spec specifies, with linear_solver_of(spec). @throws Error for unknown names
/// and invalid settings.
std::unique_ptr<dynamics::Stepper> make_stepper(dynamics::System& system, dynamics::State& state,
                                                const IntegratorSpec& spec);
/// Returns the linear solver that the spec specifies, or else the method's default (cholmod where
/// factor_kept_steps > 1); empty where the method is explicit. @throws Error for an unknown integrator
std::string linear_solver_of(const IntegratorSpec& spec);
/// Returns the relative tolerance of the method's error test with this spec (StepperEntry::error_test_rtol),
/// for multi-rate methods of the fast side; empty where steps are fixed. @throws Error for an unknown
/// integrator
std::optional<double> error_test_rtol_of(const IntegratorSpec& spec);
/// Makes the linear solver of that name with direct solvers as a fallback. It also solves unsymmetric and
/// indefinite matrices, and right-hand sides for which an iteration does not converge. Intended for matrices
/// that are usually positive definite, where no step can be shortened after a failure.
/// @throws Error for an unknown name
std::unique_ptr<dynamics::LinearSolver> make_robust_linear_solver(const std::string& name,
                                                                  const IntegratorSpec& spec = {});

/// Returns name and version of the libraries that are linked privately into this one, for the provenance of
/// results.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace palpate::integrate
