#include "palpate/core/keys.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"

namespace palpate {

const char* type_name(const Setting& like) {
  switch (like.index()) {
    case 0: return "true or false";
    case 1: return "number";
    case 2: return "text";
    default: return "three numbers";
  }
}

const char* type_demand(const Setting& like) {
  switch (like.index()) {
    case 0: return "must be true or false";
    case 1: return "must be a number";
    case 2: return "must be a string in quotes";
    default: return "must be three numbers, [x, y, z]";
  }
}

bool Range::holds(double x) const {
  return std::isfinite(x) && (low_open ? x > low : x >= low) && (high_open ? x < high : x <= high);
}

std::string Range::text() const {
  if (std::isinf(low) && std::isinf(high)) return "";
  if (std::isinf(high)) return fmt::format("{} {}", low_open ? ">" : ">=", low);
  return fmt::format("{}{}, {}{}", low_open ? '(' : '[', low, high, high_open ? ')' : ']');
}

std::string Range::demand() const {
  const std::string end = remedy.empty() ? "" : fmt::format("; {}", remedy);
  if (std::isinf(low) && std::isinf(high)) return "must be a finite number" + end;
  if (!std::isinf(high)) return "must lie in " + text() + end;
  if (low == 0.0) return (low_open ? "must be positive" : "must not be negative") + end;
  return fmt::format("must be {} {}", low_open ? "above" : "at least", low) + end;
}

std::string to_toml(double value) {
  std::string text = fmt::format("{}", value);
  return text.find_first_of(".ein") == std::string::npos ? text + ".0" : text;
}

std::string to_toml(const Setting& value) {
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const double* number = std::get_if<double>(&value)) return to_toml(*number);
  if (const std::string* text = std::get_if<std::string>(&value)) return '"' + *text + '"';
  const Vec3& v = std::get<Vec3>(value);
  return fmt::format("[{}, {}, {}]", to_toml(v[0]), to_toml(v[1]), to_toml(v[2]));
}

std::vector<PartKey> part_keys(const std::vector<std::string>& names) {
  std::vector<PartKey> out;
  for (const std::string& name : names) out.push_back({.name = name});
  return out;
}

std::string fault_of(const PartKey& key, const Setting& value) {
  if (key.fallback && key.fallback->index() != value.index()) return type_demand(*key.fallback);
  const auto fault = [&](double x) {
    if (!std::isfinite(x)) return std::string("must be a finite number");
    return key.range.holds(x) ? std::string() : key.range.demand();
  };
  if (const double* number = std::get_if<double>(&value))
    if (const std::string bad = fault(*number); !bad.empty()) return bad;
  if (const Vec3* v = std::get_if<Vec3>(&value))
    for (int i = 0; i < 3; ++i)
      if (const std::string bad = fault((*v)[i]); !bad.empty()) return bad;
  return key.fault ? key.fault(value) : "";
}

Settings complete(const std::vector<PartKey>& keys, const Settings& given, const std::string& what) {
  std::vector<std::string> names;
  for (const PartKey& key : keys) names.push_back(key.name);
  for (const auto& [name, value] : given)
    if (std::find(names.begin(), names.end(), name) == names.end())
      fail("{}: unknown key \"{}\"{}", what, name, suggestion(name, names));
  Settings out;
  for (const PartKey& key : keys) {
    const auto found = given.find(key.name);
    if (found == given.end()) {
      if (key.required) fail("{}: {} is missing and has no default", what, key.name);
      if (key.fallback) out.emplace(key.name, *key.fallback);
      continue;
    }
    if (const std::string bad = fault_of(key, found->second); !bad.empty())
      fail("{}: {} = {} {}", what, key.name, to_toml(found->second), bad);
    out.insert(*found);
  }
  return out;
}

}  // namespace palpate
