#pragma once
#include <sundials/sundials_linearsolver.h>

#include "integrate/sundials/hidden.h"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// The functions behind a SUNLinearSolver of ours.  Return values are SUNDIALS': 0 well, > 0 try a smaller
/// step, < 0 give up.
class NewtonHook {
 public:
  virtual ~NewtonHook() = default;
  virtual int setup() = 0;
  virtual int solve(N_Vector x, N_Vector b) = 0;  ///< (I - gamma J) x = b
  /// y where the nonlinear residual was last evaluated; null: unknown
  virtual N_Vector iterate() const { return nullptr; }
  virtual void project_to_psd(bool) {}  ///< from the next setup on: positive semi-definite tangents
  /// What one nonlinear solve took: iterations by the factor of an earlier one, further tries.
  virtual void count_solve(int /*kept*/, bool /*definite_retry*/, bool /*leap*/) {}
};

/// A direct linear solver and a matrix with nothing in it: SUNDIALS passes both around, the work is the
/// hook's.
SUNLinearSolver make_linear_solver(NewtonHook& hook, SUNContext context);
SUNMatrix make_matrix(SUNContext context);

}  // namespace sun
}  // namespace palpate::integrate
