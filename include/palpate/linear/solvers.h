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

/// Solves unsymmetric matrices with the help of a solver of symmetric ones, to spec.linear_rtol.  Where that
/// is a direct one, which it then has to itself: the border by its Schur complement, the body by conjugate
/// residuals over the factor of its symmetric part, of which none are needed where the body is symmetric;
/// else by gmres.  Its counters are what comes to those of `symmetric`.
std::unique_ptr<dynamics::LinearSolver> make_unsymmetric_solver(dynamics::LinearSolver& symmetric,
                                                                const IntegratorSpec& spec);

/// The libraries linked here, name and version, for a result's provenance.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace palpate::linear
