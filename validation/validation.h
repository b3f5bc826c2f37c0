#pragma once
#include <limits>
#include <string>
#include <vector>

namespace palpate::validation {

/// Refinement of a measurement: the data its order was fitted to, for charts.
struct Refinement {
  std::string size_label;           ///< Refined quantity, with its unit: "element size [m]".
  std::vector<double> size, error;  ///< One entry per level.
  std::vector<double> wall_s{};     ///< Time of the library's work per level, if measured; else empty.
};

/// One measured quantity of a case, compared with theory. NaN: not applicable.
struct Measurement {
  std::string quantity;  ///< With its unit: "tip deflection [m]".
  double computed = 0.0;
  double exact = 0.0;
  double error = 0.0;  ///< Relative unless `quantity` specifies otherwise.
  double bar = 0.0;    ///< Acceptance limit: passes when error <= bar.
  double order = std::numeric_limits<double>::quiet_NaN();      ///< Fitted over >= 3 refinements.
  double order_low = std::numeric_limits<double>::quiet_NaN();  ///< Accepted range of the fitted order.
  double order_high = std::numeric_limits<double>::quiet_NaN();
  std::string note{};
  Refinement refinement{};  ///< Empty if nothing is refined.
  /// Returns whether error <= bar (a NaN error fails) and, if an accepted range is given, the order is inside
  /// it.
  bool passed() const;
};

/// Defect of the library (a wrong sign, half the stiffness, a first-order rule), and the measurement that
/// must detect it. The request of the case is unchanged: a decorator wraps the library's part
/// (validation/faults.h), or the part is built incorrectly.
struct Fault {
  std::string name;
  std::string fails;  ///< Part of a quantity: all measurements with it, at least one, must fail.
  bool is_found(const std::vector<Measurement>& measurements) const;
};

/// Case with a known answer: one file in validation/, listed in `registry.cpp`.
struct ValidationCase {
  std::string name;     ///< "patch-test"
  std::string section;  ///< Section of docs/theory/verification.md: "C".
  std::string summary;  ///< One line: the measured quantity.
  std::string why;      ///< Why it matters, and the source of the exact answer.
  bool slow = false;    ///< Takes minutes; ctest label `slow`.
  bool quick = false;   ///< At most about 5 s on one core.
  /// Runs the case. `fault` is empty, or the name of one of `faults`.
  std::vector<Measurement> (*run)(const std::string& fault) = nullptr;
  std::vector<Fault> faults;  ///< At least one.
  double about_s = 0.0;  ///< Duration of a slow case on one core: in parallel runs the longest starts first.
};

/// Returns the observed order: least-squares slope of log(error) against log(h).
double fitted_order(const std::vector<double>& h, const std::vector<double>& error);

/// Returns all cases, in the order of their sections (defined in validation/registry.cpp).
const std::vector<ValidationCase>& validation_cases();

}  // namespace palpate::validation
