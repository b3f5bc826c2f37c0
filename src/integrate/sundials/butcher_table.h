#pragma once
#include "integrate/sundials/ark_methods.h"
#include "palpate/core/types.h"

namespace palpate::integrate {

/// A Runge-Kutta table of the installed SUNDIALS: stages A, weights b, and those of the embedded solution.
struct ButcherTable {
  MatX A;
  VecX b, embedded;
  Eigen::Index stages() const { return b.size(); }
};

ButcherTable implicit_table(const ArkMethod& method);  ///< @throws InternalError where it has none
ButcherTable explicit_table(const ArkMethod& method);
/// The implicit one, or where a method has none the explicit one.
ButcherTable leading_table(const ArkMethod& method);

}  // namespace palpate::integrate
