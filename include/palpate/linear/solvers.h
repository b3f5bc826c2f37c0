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

/// The libraries linked here, name and version, for a result's provenance.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace palpate::linear
