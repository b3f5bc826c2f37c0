#include "linear/auto_choice.h"
#include "linear/border_elimination.h"
#include "linear/direct/direct_solver.h"
#include "linear/gmres.h"
#include "linear/make.h"
#include "palpate/linear/solvers.h"

namespace palpate::linear {

const dynamics::LinearSolverRegistry& linear_solver_registry() {
  static const dynamics::LinearSolverRegistry registry = {
      {"cholmod",
       "supernodal Cholesky of SuiteSparse, AMD or METIS ordering, for symmetric positive definite matrices; "
       "with friction, GMRES preconditioned by the factor of the symmetric part",
       0, make_cholmod},
      {"umfpack", "multifrontal LU of SuiteSparse, for unsymmetric and indefinite matrices", 0, make_umfpack},
      {"gmres",
       "flexible GMRES to linear_rtol, for unsymmetric matrices (friction); preconditioned by conjugate "
       "gradients on the symmetric part, which must be positive definite",
       0, make_gmres, part_keys({"linear_rtol"})},
      {"pcg",
       "conjugate gradients to linear_rtol, block-Jacobi preconditioner, warm start, for symmetric positive "
       "definite matrices",
       0, make_pcg, part_keys({"linear_rtol"})},
      {"auto",
       "automatic choice: pcg-single, or pcg-two-level where stiffness dominates mass (squared Courant "
       "number >= 30); gmres for an unsymmetric matrix",
       0, make_auto, part_keys({"linear_rtol"})},
      {"pcg-single",
       "conjugate gradients in single precision with residuals in double, block-Jacobi preconditioner, "
       "initial guess from three previous solutions; linear_rtol bounds the error",
       0, make_pcg_single, part_keys({"linear_rtol"})},
      {"pcg-two-level",
       "pcg-single with coarse spaces added to the preconditioner (rigid motions of large and small node "
       "clusters), for stiff bodies, long steps and fine meshes",
       0, make_pcg_two_level, part_keys({"linear_rtol"})},
  };
  return registry;
}

std::unique_ptr<dynamics::LinearSolver> make_linear_solver(const std::string& name,
                                                           const IntegratorSpec& spec) {
  return find(linear_solver_registry(), name, "linear solver").make(spec);
}

std::unique_ptr<dynamics::LinearSolver> make_unsymmetric_solver(dynamics::LinearSolver& symmetric,
                                                                const IntegratorSpec& spec) {
  if (dynamic_cast<const DirectSolver*>(&symmetric))
    return std::make_unique<BorderElimination>(std::make_unique<Gmres>(spec.linear_rtol, symmetric));
  return make_gmres(spec);
}

}  // namespace palpate::linear
