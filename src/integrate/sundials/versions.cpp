#include <sundials/sundials_config.h>

#include "palpate/integrate/integrators.h"

namespace palpate::integrate {

std::vector<std::pair<std::string, std::string>> library_versions() {
  return {{"SUNDIALS", SUNDIALS_VERSION}};
}

}  // namespace palpate::integrate
