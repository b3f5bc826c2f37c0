#pragma once
#include <string>
#include <string_view>

namespace palpate {

/// A key of a scene or of a result, parted at the unit that it ends with.
struct NameAndUnit {
  std::string name;  ///< "peak_torque"
  std::string unit;  ///< "N m", in ASCII ("kg m^2"); empty where the key has none
};

/// Parts a key; the longest ending that is a unit counts.  `_n_m` is N m of a torque, a moment or friction,
/// and N/m of anything else.
NameAndUnit split_unit(std::string_view key);

}  // namespace palpate
