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

/// Values that a number may take, and what to do about one outside.  The loader of scenes and the part that
/// uses the number check it by the same Range.
struct Range {
  double low = -std::numeric_limits<double>::infinity();  ///< least value
  double high = std::numeric_limits<double>::infinity();  ///< largest value
  bool low_open = false, high_open = false;               ///< whether the bounds themselves are outside
  std::string_view remedy = {};                           ///< for the end of a message: "1e-8 is usual"

  /// (0, infinity).
  static constexpr Range positive(std::string_view remedy = {}) {
    Range r = at_least(0.0, remedy);
    r.low_open = true;
    return r;
  }
  /// [low, infinity).
  static constexpr Range at_least(double low, std::string_view remedy = {}) {
    Range r;
    r.low = low;
    r.remedy = remedy;
    return r;
  }
  /// [low, high].
  static constexpr Range closed(double low, double high, std::string_view remedy = {}) {
    Range r = at_least(low, remedy);
    r.high = high;
    return r;
  }
  /// (low, high).
  static constexpr Range open(double low, double high, std::string_view remedy = {}) {
    Range r = closed(low, high, remedy);
    r.low_open = r.high_open = true;
    return r;
  }

  /// NaN and infinity are in no range.
  bool holds(double x) const;
  std::string text() const;  ///< "> 0", ">= 1", "[0, 1]"; empty: any number
  /// "must be positive; 1e-8 is usual"
  std::string demand() const;
};

/// The value of a key as a scene gives it.
using Setting = std::variant<bool, double, std::string, Vec3>;
/// The keys of a table that have a value, by name.
using Settings = std::map<std::string, Setting>;
std::string to_toml(double value);  ///< so that it reads back exactly, and as a number with a point
/// As a scene file writes it: text in quotes, a vector as an array.
std::string to_toml(const Setting& value);

/// One key of a scene that a registry entry uses.  Keys of an entry that no other table of keys describes
/// (those of an obstacle) have their default and meaning here as well.
struct PartKey {
  std::string name;       ///< as it stands in the scene's table
  Range range = {};       ///< of each number; narrower than the key's own where the entry can take less
  bool required = false;  ///< a scene that leaves it out is refused
  std::optional<Setting> fallback = {};  ///< the default, and with it the type
  std::string meaning = {};              ///< one line
  /// what is wrong beyond type and range, in words that follow "KEY = VALUE"; empty: nothing
  std::string (*fault)(const Setting& value) = nullptr;
};

/// Keys by their names alone: whatever the key's own range holds will do.
std::vector<PartKey> part_keys(const std::vector<std::string>& names);

const char* type_name(const Setting& like);    ///< "number"
const char* type_demand(const Setting& like);  ///< "must be a number"

/// What is wrong with a value, in words that follow "KEY = VALUE"; empty: nothing.
std::string fault_of(const PartKey& key, const Setting& value);

/// `given` with the defaults of what it leaves out.
/// @throws Error beginning with `what` for a key that is not in `keys`, is missing, or has a bad value
Settings complete(const std::vector<PartKey>& keys, const Settings& given, const std::string& what);

}  // namespace palpate
