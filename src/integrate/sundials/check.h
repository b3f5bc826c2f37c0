#pragma once
#include <string>
#include <string_view>

#include "integrate/sundials/hidden.h"

/// Functions with SUNDIALS types in their signatures are not exported from the library.
namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// Returns the name of a call's return value in its library: "CV_CONV_FAILURE" for CVode and -4,
/// "KIN_MEM_FAIL" for KINSol and -4; for the calls that set up linear solvers, whose numbers have other
/// meanings, "CVLS_ILL_INPUT" and similar. "flag -4" where there is none.
/// @param call  the function's name, or its prefix: CVode, ARKStep, MRIStep, IDA, KIN
/// @param flag  the return value
std::string flag_name(std::string_view call, long flag);

/// Checks a SUNDIALS call that must succeed: a negative flag is a programming error.
/// @throws InternalError with the call, the flag's name, time and step
void check(long flag, const char* call, double t, double h);
/// Checks the result of a constructor, where a null pointer is the failure.
void check(const void* object, const char* call);

}  // namespace sun
}  // namespace palpate::integrate
