#pragma once
#include <arkode/arkode_mristep.h>

#include <string_view>

namespace palpate::integrate {
namespace sun __attribute__((visibility("hidden"))) {

  struct MultirateMethod {
    const char* name;
    ARKODE_MRITableID table;
    int order;
  };
  /// @throws Error for another name
  const MultirateMethod& multirate_method(std::string_view name);

}  // namespace )
}  // namespace palpate::integrate
