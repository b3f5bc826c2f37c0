#include <cholmod.h>
#include <fmt/format.h>
#include <umfpack.h>

#include "palpate/linear/solvers.h"

namespace palpate::linear {

std::vector<std::pair<std::string, std::string>> library_versions() {
  return {
      {"CHOLMOD", fmt::format("{}.{}.{}", CHOLMOD_MAIN_VERSION, CHOLMOD_SUB_VERSION, CHOLMOD_SUBSUB_VERSION)},
      {"UMFPACK",
       fmt::format("{}.{}.{}", UMFPACK_MAIN_VERSION, UMFPACK_SUB_VERSION, UMFPACK_SUBSUB_VERSION)}};
}

}  // namespace palpate::linear
