#pragma once
#include <arkode/arkode_mristep.h>

#include <string_view>

#include "integrate/sundials/hidden.h"
#include "palpate/core/types.h"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// Multi-rate method of ARKODE's MRIStep.
struct MultirateMethod {
  const char* name;
  ARKODE_MRITableID table;
  int order;
};
/// Returns the method of that name. @throws Error for another name
const MultirateMethod& multirate_method(std::string_view name);

/// Returns the matrix of one step on y' = (slow + fast) y, with the fast side integrated exactly.
MatX multirate_step(std::string_view method, const MatX& slow, const MatX& fast, double step_s);

}  // namespace sun
}  // namespace palpate::integrate
