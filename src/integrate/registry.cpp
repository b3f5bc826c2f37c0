#include "integrate/make.h"
#include "integrate/step_solver.h"
#include "palpate/integrate/integrators.h"

namespace palpate::integrate {

using dynamics::Stability;
using dynamics::StepControl;

const dynamics::StepperRegistry& stepper_registry() {
  static const dynamics::StepperRegistry registry = {
      {"cvode-bdf", "backward differences of SUNDIALS CVODE, order 1 to 5 (max_order)",
       {"BDF", 5, 5, StepControl::kAdaptive, Stability::kAlpha, true, true, "force, tangent"}, make_cvode_bdf},
      {"ark-erk-5", "Cash-Karp 5(4) of SUNDIALS ARKODE; no linear solver; checks references",
       {"explicit Runge-Kutta", 5, 0, StepControl::kAdaptive, Stability::kExplicit, false, false, "force"}, make_ark_erk},
      {"linearly-implicit-euler", "one linear solve a step; the interactive method of Galoppo et al. 2007",
       {"Euler", 1, 1, StepControl::kFixed, Stability::kL, true, false, "force, tangent"}, make_linearly_implicit_euler},
  };
  return registry;
}

const dynamics::LinearSolverRegistry& linear_solver_registry() {
  static const dynamics::LinearSolverRegistry registry = {
      {"cholmod", "supernodal Cholesky of SuiteSparse, ordered by AMD or METIS; symmetric positive definite matrices", 0, make_cholmod},
      {"umfpack", "multifrontal LU of SuiteSparse; unsymmetric and indefinite matrices", 0, make_umfpack},
      {"klu", "left-looking LU of SuiteSparse, pivot order kept; unsymmetric and indefinite matrices, small or very sparse", 0, make_klu},
      {"pcg", "conjugate gradients, block-Jacobi, warm start, to linear_rtol; symmetric positive definite matrices", 0, make_pcg},
  };
  return registry;
}

std::unique_ptr<dynamics::Stepper> make_stepper(dynamics::System& system, dynamics::State& state, const IntegratorSpec& spec) {
  const auto& entry = find(stepper_registry(), spec.name, "integrator");
  find(linear_solver_registry(), spec.linear_solver, "linear solver");  // a wrong name is refused even where it would not be used
  auto solver = entry.traits.implicit ? make_linear_solver(spec.linear_solver, spec) : nullptr;
  return entry.make(system, state, spec, std::move(solver));
}

std::unique_ptr<dynamics::LinearSolver> make_linear_solver(const std::string& name, const IntegratorSpec& spec) {
  return find(linear_solver_registry(), name, "linear solver").make(spec);
}

std::unique_ptr<dynamics::LinearSolver> make_robust_linear_solver(const std::string& name, const IntegratorSpec& spec) {
  return std::make_unique<StepSolver>(make_linear_solver(name, spec), spec);
}

}  // namespace palpate::integrate
