#pragma once
#include "integrate/sundials/ark_methods.h"
#include "palpate/core/types.h"

namespace palpate::integrate {

/// Runge-Kutta table of the installed SUNDIALS: stages A, weights b, and weights of the embedded solution.
struct ButcherTable {
  MatX A;
  VecX b, embedded;
  Eigen::Index stages() const { return b.size(); }
};

ButcherTable implicit_table(const ArkMethod& method);  ///< @throws InternalError where the method has none
/// As implicit_table().
ButcherTable explicit_table(const ArkMethod& method);
/// Returns the implicit table, or the explicit one where a method has no implicit one.
ButcherTable leading_table(const ArkMethod& method);

}  // namespace palpate::integrate
