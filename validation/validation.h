#pragma once
#include <limits>
#include <string>
#include <vector>

namespace palpate::validation {

/// A measurement over a refinement: what its order was fitted to, for charts.
struct Refinement {
  std::string size_label;           ///< what is refined, with its unit: "element size [m]"
  std::vector<double> size, error;  ///< one each
  std::vector<double> wall_s{};     ///< of the library's work at each, where it was timed; else empty
};

/// One measured quantity of a case, held against theory.  NaN: not applicable.
struct Measurement {
  std::string quantity;  ///< with its unit: "tip deflection [m]"
  double computed = 0.0;
  double exact = 0.0;
  double error = 0.0;                                           ///< relative unless `quantity` says otherwise
  double bar = 0.0;                                             ///< passes when error <= bar
  double order = std::numeric_limits<double>::quiet_NaN();      ///< fitted over >= 3 refinements
  double order_low = std::numeric_limits<double>::quiet_NaN();  ///< band of the fitted order
  double order_high = std::numeric_limits<double>::quiet_NaN();
  std::string note{};
  Refinement refinement{};  ///< empty where nothing is refined
  /// error <= bar (a NaN error fails) and, where a band is given, order inside it
  bool passed() const;
};

/// The library with a defect (a wrong sign, half the stiffness, a first-order rule), and the measurement that
/// is there to find it.  What the case asks of the library stays as it is: a decorator of the library's own
/// part (validation/faults.h), or the part made wrongly.
struct Fault {
  std::string name;
  std::string fails;  ///< part of a quantity: every measurement whose quantity has it must fail, one at least
  bool is_found(const std::vector<Measurement>& measurements) const;
};

/// A case with a known answer.  Stands in validation/ as one file; `registry.cpp` lists it.
struct ValidationCase {
  std::string name;     ///< "patch-test"
  std::string section;  ///< of docs/theory/verification.md: "C"
  std::string summary;  ///< one line: what is measured
  std::string why;      ///< why it matters, and the source of the exact answer
  bool slow = false;    ///< minutes; ctest label `slow`
  bool quick = false;   ///< at most about 5 s on one core
  /// Runs it.  `fault` is empty, or the name of one of `faults`.
  std::vector<Measurement> (*run)(const std::string& fault) = nullptr;
  std::vector<Fault> faults;  ///< at least one
  double about_s = 0.0;       ///< of a slow one, on one core: side by side the longest begins first
};

/// Observed order: least-squares slope of log(error) against log(h).
double fitted_order(const std::vector<double>& h, const std::vector<double>& error);

/// All cases, in the order of their sections (defined in validation/registry.cpp).
const std::vector<ValidationCase>& validation_cases();

}  // namespace palpate::validation
