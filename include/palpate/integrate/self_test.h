#pragma once
#include <string>
#include <vector>

/// Proof that the SUNDIALS inside this library is the one it was built with, whatever else the process has
/// loaded.
namespace palpate::integrate::self_test {

/// Each integrates y' = -y, y(0) = 1 to t with SUNDIALS' own vectors, dense matrices and Newton, at rtol
/// 1e-10, atol 1e-12: y(t), exp(-t) to 1e-6. NaN when a call fails (as it does where another library's
/// symbols of the same names were bound).
double cvode(double t);
/// As cvode(), by ARKODE.
double arkode(double t);
/// As cvode(), by IDA.
double ida(double t);

/// What one of the libraries answered.
struct Answer {
  std::string library;  ///< "CVODE", "ARKODE" or "IDA"
  double y = 0.0;       ///< y(t); NaN where a call failed
};
/// The three of them.
std::vector<Answer> all(double t);

/// What an error message calls the value that a call of SUNDIALS returned: "CV_CONV_FAILURE" for ("CVode",
/// -4).
std::string flag_name(const std::string& call, long flag);

}  // namespace palpate::integrate::self_test
