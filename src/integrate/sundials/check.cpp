#include "integrate/sundials/check.h"

#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_mristep.h>
#include <cvode/cvode.h>
#include <cvode/cvode_ls.h>
#include <ida/ida.h>
#include <ida/ida_ls.h>
#include <kinsol/kinsol.h>
#include <kinsol/kinsol_ls.h>

#include <cstdlib>

#include "integrate/sundials/release.h"
#include "palpate/core/error.h"

namespace palpate::integrate::sun {
namespace {

using Namer = char* (*)(long);
/// One library: `name` for its return values, `linear_name` for its linear solver interface.
struct Library {
  std::string_view prefix;
  Namer name, linear_name;
};
constexpr Library kLibraries[] = {{"CVode", CVodeGetReturnFlagName, CVodeGetLinReturnFlagName},
                                  {"ARKStep", ARKStepGetReturnFlagName, ARKStepGetLinReturnFlagName},
                                  {"MRIStep", MRIStepGetReturnFlagName, MRIStepGetLinReturnFlagName},
                                  {"IDA", IDAGetReturnFlagName, IDAGetLinReturnFlagName},
                                  {"KIN", KINGetReturnFlagName, KINGetLinReturnFlagName}};

/// CVodeSetLinearSolver, IDASetJacFn and similar; not CVodeSetNonlinearSolver.
bool is_of_linear_solver(std::string_view call) {
  return call.find("Lin") != call.npos || call.find("Jac") != call.npos;
}

}  // namespace

std::string flag_name(std::string_view call, long flag) {
  for (const Library& library : kLibraries) {
    if (!call.starts_with(library.prefix)) continue;
    char* owned = (is_of_linear_solver(call) ? library.linear_name : library.name)(flag);
    const std::string name = owned ? owned : "NONE";
    std::free(owned);
    if (name != "NONE") return name;
  }
  return fmt::format("flag {}", flag);
}

void check(long flag, const char* call, double t, double h) {
  PALPATE_CHECK(flag >= 0, "{} returned {} ({}) at t = {}, h = {}", call, flag_name(call, flag), flag, t, h);
}

void check(const void* object, const char* call) {
  PALPATE_CHECK(object, "{} returned a null pointer", call);
}

}  // namespace palpate::integrate::sun
