#pragma once
#include <arkode/arkode_mristep.h>

#include <string_view>

#include "integrate/sundials/hidden.h"
#include "palpate/core/types.h"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

struct MultirateMethod {
  const char* name;
  ARKODE_MRITableID table;
  int order;
};
/// @throws Error for another name
const MultirateMethod& multirate_method(std::string_view name);

/// The matrix of one step on y' = (slow + fast) y, the fast side integrated exactly.
MatX multirate_step(std::string_view method, const MatX& slow, const MatX& fast, double step_s);

}  // namespace sun
}  // namespace palpate::integrate
