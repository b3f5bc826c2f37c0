#pragma once
#include <string>
#include <string_view>

namespace palpate {

/// Key of a scene or a result, split at its unit suffix.
struct NameAndUnit {
  std::string name;  ///< "peak_torque"
  std::string unit;  ///< "N m", in ASCII ("kg m^2"); empty where the key has none
};

/// Splits a key; the longest suffix that is a unit counts.  `_n_m` means N m for a torque, a moment or
/// friction, and N/m otherwise.
NameAndUnit split_unit(std::string_view key);

}  // namespace palpate
