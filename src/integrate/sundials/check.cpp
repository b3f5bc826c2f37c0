#include "integrate/sundials/check.h"

#include <cvode/cvode.h>

#include <cstdlib>

#include "palpate/core/error.h"

namespace palpate::integrate::sun {

std::string cvode_flag_name(long flag) {
  char* owned = CVodeGetReturnFlagName(flag);
  std::string name = owned ? owned : "UNKNOWN";
  std::free(owned);
  return name == "NONE" ? fmt::format("flag {}", flag) : name;
}

void check(long flag, const char* call, double t, double h) {
  PALPATE_CHECK(flag >= 0, "{} returned {} ({}) at t = {}, h = {}", call, cvode_flag_name(flag), flag, t, h);
}

void check(const void* object, const char* call) { PALPATE_CHECK(object, "{} returned nothing", call); }

}  // namespace palpate::integrate::sun
