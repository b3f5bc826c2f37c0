#include <cstdio>  // SUNDIALS 6.4 omits it: arkode_butcher.h uses FILE.

#include "integrate/sundials/butcher_table.h"

#include <arkode/arkode_butcher_dirk.h>
#include <arkode/arkode_butcher_erk.h>

#include "integrate/sundials/check.h"
#include "palpate/core/error.h"

namespace palpate::integrate {
namespace {

ButcherTable take(ARKodeButcherTable table) {
  sun::check(table, "ARKodeButcherTable_Load");
  const int s = table->stages;
  ButcherTable out{MatX(s, s), Eigen::Map<const VecX>(table->b, s), Eigen::Map<const VecX>(table->d, s)};
  for (int i = 0; i < s; ++i)
    for (int j = 0; j < s; ++j) out.A(i, j) = table->A[i][j];
  ARKodeButcherTable_Free(table);
  return out;
}

}  // namespace

ButcherTable implicit_table(const ArkMethod& method) {
  PALPATE_CHECK(method.implicit_table >= 0, "{} has no implicit table", method.name);
  return take(ARKodeButcherTable_LoadDIRK(static_cast<ARKODE_DIRKTableID>(method.implicit_table)));
}

ButcherTable explicit_table(const ArkMethod& method) {
  PALPATE_CHECK(method.explicit_table >= 0, "{} has no explicit table", method.name);
  return take(ARKodeButcherTable_LoadERK(static_cast<ARKODE_ERKTableID>(method.explicit_table)));
}

ButcherTable leading_table(const ArkMethod& method) {
  return method.implicit_table >= 0 ? implicit_table(method) : explicit_table(method);
}

}  // namespace palpate::integrate
