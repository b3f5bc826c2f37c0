#pragma once
#include <sundials/sundials_linearsolver.h>

#include "integrate/sundials/hidden.h"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// Functions behind a SUNLinearSolver of this library. Return values follow SUNDIALS: 0 success, > 0 try a
/// smaller step, < 0 stop.
class NewtonHook {
 public:
  virtual ~NewtonHook() = default;
  /// Prepares the factor.
  virtual int setup() = 0;
  virtual int solve(N_Vector x, N_Vector b) = 0;  ///< Solves (I - gamma J) x = b.
  /// Returns y where the nonlinear residual was last evaluated; null: unknown.
  virtual N_Vector iterate() const { return nullptr; }
  virtual void project_to_psd(bool) {}  ///< Switches positive semi-definite tangents, from the next setup on.
  /// Counts the work of one nonlinear solve: iterations with the factor of an earlier one, further tries.
  virtual void record_solve(int /*kept*/, bool /*definite_retry*/, bool /*leap*/) {}
};

/// Makes a direct linear solver, which calls the hook, and an empty matrix: SUNDIALS only passes them around.
SUNLinearSolver make_linear_solver(NewtonHook& hook, SUNContext context);
SUNMatrix make_matrix(SUNContext context);

}  // namespace sun
}  // namespace palpate::integrate
