#pragma once
#include <string>

/// Names with SUNDIALS types in their signatures stay inside the library.
namespace palpate::integrate {
namespace sun __attribute__((visibility("hidden"))) {

/// "CV_CONV_FAILURE" for -4.
std::string cvode_flag_name(long flag);

/// Every SUNDIALS call that must succeed goes through here: a negative flag is a mistake of ours.
/// @throws InternalError with the call, the flag's name, time and step
void check(long flag, const char* call, double t, double h);
/// For constructors: a null pointer is the failure.
void check(const void* object, const char* call);

}  // namespace sun
}  // namespace palpate::integrate
