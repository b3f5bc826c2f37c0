#include "integrate/make.h"
#include "palpate/integrate/integrators.h"

namespace palpate::integrate {

const dynamics::StepperRegistry& stepper_registry() {
  static const dynamics::StepperRegistry registry = {
      {"cvode-bdf", "SUNDIALS CVODE: backward differences, order 1 to 5, error control (rtol, atol_q, atol_u, max_order)", 0, make_cvode_bdf},
      {"ark-erk-5", "SUNDIALS ARKODE: explicit Runge-Kutta 5(4), error control (rtol, atol_q, atol_u); no linear solver; checks references", 0, make_ark_erk},
      {"linearly-implicit-euler", "one linear solve a step, fixed step (step_s); the interactive method of Galoppo et al. 2007", 1,
       make_linearly_implicit_euler},
  };
  return registry;
}

const dynamics::LinearSolverRegistry& linear_solver_registry() {
  static const dynamics::LinearSolverRegistry registry = {
      {"cholmod", "supernodal Cholesky of SuiteSparse; symmetric positive definite matrices", 0, make_cholmod},
      {"umfpack", "multifrontal LU of SuiteSparse; unsymmetric and indefinite matrices", 0, make_umfpack},
  };
  return registry;
}

std::unique_ptr<dynamics::Stepper> make_stepper(dynamics::System& system, dynamics::State& state, const IntegratorSpec& spec) {
  const auto& entry = find(stepper_registry(), spec.name, "integrator");
  return entry.make(system, state, spec, make_linear_solver(spec.linear_solver));
}

std::unique_ptr<dynamics::LinearSolver> make_linear_solver(const std::string& name) {
  return find(linear_solver_registry(), name, "linear solver").make();
}

}  // namespace palpate::integrate
