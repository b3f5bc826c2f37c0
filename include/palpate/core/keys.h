#pragma once
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "palpate/core/types.h"

namespace palpate {

/// Admissible interval of a number, with the remedy for a value outside.  The scene loader and the part that
/// uses the number check it with the same Range.
struct Range {
  double low = -std::numeric_limits<double>::infinity();  ///< Lower bound.
  double high = std::numeric_limits<double>::infinity();  ///< Upper bound.
  bool low_open = false, high_open = false;               ///< Whether the bound itself is excluded.
  std::string_view remedy = {};                           ///< End of the error message: "1e-8 is usual".

  /// Returns (0, infinity).
  static constexpr Range positive(std::string_view remedy = {}) {
    Range r = at_least(0.0, remedy);
    r.low_open = true;
    return r;
  }
  /// Returns [low, infinity).
  static constexpr Range at_least(double low, std::string_view remedy = {}) {
    Range r;
    r.low = low;
    r.remedy = remedy;
    return r;
  }
  /// Returns [low, high].
  static constexpr Range closed(double low, double high, std::string_view remedy = {}) {
    Range r = at_least(low, remedy);
    r.high = high;
    return r;
  }
  /// Returns (low, high).
  static constexpr Range open(double low, double high, std::string_view remedy = {}) {
    Range r = closed(low, high, remedy);
    r.low_open = r.high_open = true;
    return r;
  }

  /// Whether x lies in the range; false for NaN and infinity.
  bool holds(double x) const;
  std::string text() const;  ///< "> 0", ">= 1", "[0, 1]"; empty for an unbounded range.
  /// Returns the requirement for an error message: "must be positive; 1e-8 is usual".
  std::string demand() const;
};

/// Value of a scene key.
using Setting = std::variant<bool, double, std::string, Vec3>;
/// Values of a scene table, by key.
using Settings = std::map<std::string, Setting>;
std::string to_toml(double value);  ///< Shortest decimal that reads back exactly, always a TOML float.
/// Returns the value as a scene file writes it: text in quotes, a vector as an array.
std::string to_toml(const Setting& value);

/// Key of the scene that a registry entry uses.  For entries whose keys no other table describes (obstacles),
/// it also holds default and meaning.
struct PartKey {
  std::string name;  ///< Key in the scene's table.
  /// Range of each number; narrower than the key's general range where the entry requires it.
  Range range = {};
  bool required = false;                 ///< Whether a scene without the key is rejected.
  std::optional<Setting> fallback = {};  ///< Default value; its type is the type of the key.
  std::string meaning = {};              ///< Description of one line.
  /// Returns the fault beyond type and range, as the continuation of "KEY = VALUE"; empty for none.
  std::string (*fault)(const Setting& value) = nullptr;
};

/// Returns PartKeys with names only: no restriction beyond the keys' general ranges.
std::vector<PartKey> part_keys(const std::vector<std::string>& names);

const char* type_name(const Setting& like);    ///< Name of the value's type: "number".
const char* type_demand(const Setting& like);  ///< Requirement for an error message: "must be a number".

/// Returns the fault of a value, as the continuation of "KEY = VALUE"; empty for none.
std::string fault_of(const PartKey& key, const Setting& value);

/// Returns `given`, completed with defaults.
/// @throws Error beginning with `what` for a key that is not in `keys`, is missing, or has a bad value
Settings complete(const std::vector<PartKey>& keys, const Settings& given, const std::string& what);

}  // namespace palpate
