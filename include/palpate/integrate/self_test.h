#pragma once
#include <string>
#include <vector>

/// Checks that the SUNDIALS inside this library is the one it was built with, regardless of other libraries
/// in the process.
namespace palpate::integrate::self_test {

/// Integrates y' = -y, y(0) = 1 to t by CVODE, with SUNDIALS' vectors, dense matrices and Newton solver, at
/// rtol 1e-10, atol 1e-12. Returns y(t), which equals exp(-t) to 1e-6; NaN when a call fails (as it does when
/// symbols of the same names from another library were bound).
double cvode(double t);
/// As cvode(), by ARKODE.
double arkode(double t);
/// As cvode(), by IDA.
double ida(double t);

/// Result of one library.
struct Answer {
  std::string library;  ///< "CVODE", "ARKODE" or "IDA".
  double y = 0.0;       ///< y(t); NaN where a call failed.
};
/// Runs all three.
std::vector<Answer> all(double t);

/// Returns the name of a return value of a SUNDIALS call, as used in error messages: "CV_CONV_FAILURE" for
/// ("CVode", -4).
std::string flag_name(const std::string& call, long flag);

}  // namespace palpate::integrate::self_test
