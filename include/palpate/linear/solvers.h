#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "palpate/dynamics/linear_solver.h"

namespace palpate::linear {

/// Every linear solver, by the name used in scenes, on the command line and in reports.
const dynamics::LinearSolverRegistry& linear_solver_registry();

/// @throws Error for an unknown name and for settings that the solver cannot serve
std::unique_ptr<dynamics::LinearSolver> make_linear_solver(const std::string& name,
                                                           const IntegratorSpec& spec = {});

/// Makes a solver of unsymmetric matrices from a solver of symmetric ones, by GMRES to spec.linear_rtol.
/// Where `symmetric` is a direct solver it preconditions the body, and the border is eliminated by its Schur
/// complement; a symmetric body takes the factor alone.  Otherwise "pcg-two-level" preconditions the whole.
/// @param spec  its settings are the solver's
/// @param symmetric  outlives the result, whose counters are to be added to its own; what it factors in
///   between costs another factorisation at the next factor()
std::unique_ptr<dynamics::LinearSolver> make_unsymmetric_solver(dynamics::LinearSolver& symmetric,
                                                                const IntegratorSpec& spec);

/// The libraries linked here, name and version, for a result's provenance.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace palpate::linear
