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
       "supernodal Cholesky of SuiteSparse, ordered by AMD or METIS; symmetric positive definite matrices; "
       "with friction, GMRES preconditioned by the factor of the symmetric part",
       0, make_cholmod},
      {"umfpack", "multifrontal LU of SuiteSparse; unsymmetric and indefinite matrices", 0, make_umfpack},
      {"gmres",
       "flexible GMRES to linear_rtol, preconditioned by conjugate gradients on the symmetric part, which "
       "must be positive definite; unsymmetric matrices, as friction makes them",
       0, make_gmres, part_keys({"linear_rtol"})},
      {"pcg",
       "conjugate gradients, block-Jacobi, warm start, to linear_rtol; symmetric positive definite matrices",
       0, make_pcg, part_keys({"linear_rtol"})},
      {"auto",
       "pcg-single, or pcg-two-level where stiffness outweighs mass in the matrix (squared Courant number of "
       "at least 30); gmres for an unsymmetric matrix",
       0, make_auto, part_keys({"linear_rtol"})},
      {"pcg-single",
       "conjugate gradients in single precision with residuals in double, block-Jacobi, start from three "
       "solutions; linear_rtol bounds the error",
       0, make_pcg_single, part_keys({"linear_rtol"})},
      {"pcg-two-level",
       "pcg-single with rigid motions of node clusters, large and small, beside its blocks: for stiff "
       "bodies, long steps and fine meshes",
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
