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

/// Solves unsymmetric matrices with the help of a solver of symmetric ones, to spec.linear_rtol.  Where
/// `symmetric` is a direct solver: the border by its Schur complement, the body by conjugate residuals over
/// the factor of its symmetric part, or by that factor alone where the body is symmetric; else by gmres.
/// @param spec  its settings are the solver's
/// @param symmetric  outlives the result, whose counters are to be added to its own; what it factors in
///   between costs another factorisation at the next factor()
std::unique_ptr<dynamics::LinearSolver> make_unsymmetric_solver(dynamics::LinearSolver& symmetric,
                                                                const IntegratorSpec& spec);

/// The libraries linked here, name and version, for a result's provenance.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace palpate::linear
