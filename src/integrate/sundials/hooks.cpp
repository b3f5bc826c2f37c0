#include "integrate/sundials/hooks.h"

#include "integrate/sundials/check.h"
#include "integrate/sundials/release.h"

namespace palpate::integrate::sun {
namespace {

NewtonHook& hook_of(SUNLinearSolver solver) { return *static_cast<NewtonHook*>(solver->content); }

int free_solver(SUNLinearSolver solver) {
  solver->content = nullptr;  // Owned by the caller.
  SUNLinSolFreeEmpty(solver);
  return kSuccess;
}

void free_matrix(SUNMatrix matrix) { SUNMatFreeEmpty(matrix); }

}  // namespace

SUNLinearSolver make_linear_solver(NewtonHook& hook, SUNContext context) {
  SUNLinearSolver solver = SUNLinSolNewEmpty(context);
  check(solver, "SUNLinSolNewEmpty");
  solver->content = &hook;
  solver->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_DIRECT; };
  solver->ops->getid = [](SUNLinearSolver) { return SUNLINEARSOLVER_CUSTOM; };
  solver->ops->setup = [](SUNLinearSolver s, SUNMatrix) { return hook_of(s).setup(); };
  solver->ops->solve = [](SUNLinearSolver s, SUNMatrix, N_Vector x, N_Vector b, sunrealtype) {
    return hook_of(s).solve(x, b);
  };
  solver->ops->free = free_solver;
  return solver;
}

SUNMatrix make_matrix(SUNContext context) {
  SUNMatrix matrix = SUNMatNewEmpty(context);
  check(matrix, "SUNMatNewEmpty");
  matrix->ops->getid = [](SUNMatrix) { return SUNMATRIX_CUSTOM; };
  matrix->ops->zero = [](SUNMatrix) { return kSuccess; };  // IDA clears the matrix that it passes on.
  matrix->ops->destroy = free_matrix;
  return matrix;
}

}  // namespace palpate::integrate::sun
