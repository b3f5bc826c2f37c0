#include "json.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/core/error.h"
#include "palpate/report/table.h"
#include "palpate/store/atomic_file.h"
#include "palpate/store/json_text.h"

namespace palpate::report {

Json read_json(const std::filesystem::path& path) {
  return store::parse_json(store::read_file(path.string()), path.string());
}

double number_at(const Json& object, const char* key) {
  if (!object.is_object() || !object.contains(key) || !object[key].is_number())
    return std::numeric_limits<double>::quiet_NaN();
  return object[key].get<double>();
}

std::string text_at(const Json& object, const char* key, const std::string& otherwise) {
  return object.is_object() && object.contains(key) && object[key].is_string()
             ? object[key].get<std::string>()
             : otherwise;
}

std::string value_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_integer()) return fmt::format("{}", value.get<long long>());
  if (value.is_number()) return fmt::format("{:.4g}", value.get<double>());
  std::string text;
  if (value.is_array())
    for (const Json& item : value)
      if (const std::string part = value_text(item); !part.empty()) text += (text.empty() ? "" : ", ") + part;
  return text;
}

std::string key_text(const std::string& key) {
  static const std::vector<std::pair<std::string, std::string>> units = {{"_gflop_s", "Gflop/s"},
                                                                         {"_gb_s", "GB/s"},
                                                                         {"_kg_m3", "kg/m³"},
                                                                         {"_n_s_m", "N s/m"},
                                                                         {"_n_m", "N m"},
                                                                         {"_m_s2", "m/s²"},
                                                                         {"_m_s", "m/s"},
                                                                         {"_pa", "Pa"},
                                                                         {"_kg", "kg"},
                                                                         {"_mib", "MiB"},
                                                                         {"_hz", "Hz"},
                                                                         {"_rad", "rad"},
                                                                         {"_ms", "ms"},
                                                                         {"_us", "µs"},
                                                                         {"_s", "s"},
                                                                         {"_n", "N"},
                                                                         {"_m", "m"},
                                                                         {"_j", "J"}};
  if (key == "gflop_s") return "Gflop/s";
  std::string name = key, unit;
  for (const auto& [ending, text] : units) {
    if (!key.ends_with(ending) || key.size() == ending.size()) continue;
    name = key.substr(0, key.size() - ending.size());
    unit = " [" + text + "]";
    break;
  }
  std::replace(name.begin(), name.end(), '_', ' ');
  return name + unit;
}

std::vector<std::pair<std::string, std::string>> facts_of(const Json& object) {
  std::vector<std::pair<std::string, std::string>> facts;
  if (!object.is_object()) return facts;
  for (const auto& [key, value] : object.items()) {
    if (value.is_object()) continue;
    if (std::string text = value_text(value); !text.empty())
      facts.emplace_back(key_text(key), std::move(text));
  }
  return facts;
}

}  // namespace palpate::report
