#pragma once
#include <string>
#include <string_view>

#include "integrate/sundials/hidden.h"

/// Names with SUNDIALS types in their signatures stay inside the library.
namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// The name that the library of a call has for its return value: "CV_CONV_FAILURE" for CVode and -4,
/// "KIN_MEM_FAIL" for KINSol and -4; of the calls that set up linear solvers, whose numbers mean something
/// else again, "CVLS_ILL_INPUT" and its like.  "flag -4" where there is none.
/// @param call  the function's name, or its prefix: CVode, ARKStep, MRIStep, IDA, KIN
std::string flag_name(std::string_view call, long flag);

/// Every SUNDIALS call that must succeed goes through here: a negative flag is a mistake of ours.
/// @throws InternalError with the call, the flag's name, time and step
void check(long flag, const char* call, double t, double h);
/// For constructors: a null pointer is the failure.
void check(const void* object, const char* call);

}  // namespace sun
}  // namespace palpate::integrate
