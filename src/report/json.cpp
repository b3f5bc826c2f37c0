#include "json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/units.h"
#include "palpate/core/error.h"
#include "report/table.h"
#include "store/atomic_file.h"
#include "store/json_text.h"

namespace palpate::report {

Json read_json(const std::filesystem::path& path) {
  return store::parse_json(store::read_file(path.string()), path.string());
}

namespace {

Json figures_at(const Json& summary, const char* name) {
  if (!summary.is_object() || !summary.contains("figures") || !summary["figures"].is_object() ||
      !summary["figures"].contains(name))
    return {};
  return summary["figures"][name];
}

}  // namespace

Json section_of(const Json& summary, const char* name) {
  Json section = figures_at(summary, name);
  return section.is_object() ? section : Json::object();
}

Json list_of(const Json& summary, const char* name) {
  Json list = figures_at(summary, name);
  return list.is_array() ? list : Json::array();
}

Json row_where(const Json& list, const char* key, const std::string& text) {
  for (const Json& row : list)
    if (text_at(row, key) == text) return row;
  return Json::object();
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
  if (key == "gflop_s") return "Gflop/s";
  auto [name, unit] = split_unit(key);
  if (const std::size_t at = name.find("p99_9"); at != std::string::npos) name.replace(at, 5, "p99.9");
  std::replace(name.begin(), name.end(), '_', ' ');
  if (unit.empty()) return name;
  for (const auto& [plain, set] : std::array{std::pair{"^2", "²"}, std::pair{"^3", "³"}})
    if (const std::size_t at = unit.find(plain); at != std::string::npos) unit.replace(at, 2, set);
  return name + " [" + (unit == "us" ? "µs" : unit) + "]";
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
