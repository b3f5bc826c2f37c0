#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "palpate/dynamics/linear_solver.h"

namespace palpate::linear {

/// Returns all linear solvers by the name used in scenes, on the command line and in reports.
const dynamics::LinearSolverRegistry& linear_solver_registry();

/// Builds the solver of this name from the settings in `spec`.
/// @throws Error for an unknown name and for settings outside the solver's range
std::unique_ptr<dynamics::LinearSolver> make_linear_solver(const std::string& name,
                                                           const IntegratorSpec& spec = {});

/// Builds a solver for unsymmetric matrices: GMRES to relative tolerance spec.linear_rtol. If `symmetric` is
/// a direct solver, the border (rigid tool) is eliminated by its Schur complement, and the factor of the
/// body's symmetric part preconditions GMRES; a symmetric body takes the factor alone. Otherwise
/// "pcg-two-level" preconditions the whole, and `symmetric` is not used.
/// @param symmetric  Must outlive the result. The result's counters exclude its counts: add both. If it
///   factors another matrix in between, the next factor() repeats the factorisation.
/// @param spec  Settings: linear_rtol, threads.
std::unique_ptr<dynamics::LinearSolver> make_unsymmetric_solver(dynamics::LinearSolver& symmetric,
                                                                const IntegratorSpec& spec);

/// Returns the name and version of each linked solver library, for a result's provenance.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace palpate::linear
