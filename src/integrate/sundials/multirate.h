#pragma once
#include <arkode/arkode_mristep.h>

#include <string_view>

#include "integrate/sundials/hidden.h"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

struct MultirateMethod {
  const char* name;
  ARKODE_MRITableID table;
  int order;
};
/// @throws Error for another name
const MultirateMethod& multirate_method(std::string_view name);

}  // namespace sun
}  // namespace palpate::integrate
