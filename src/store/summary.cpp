#include "store/summary.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/json_text.h"

namespace palpate::store {
namespace {
using Json = nlohmann::ordered_json;

Json json_of(const SummaryValue& value) {
  // The library writes NaN and infinity as null.
  return std::visit([](const auto& v) { return Json(v); }, value);
}

SummaryValue value_of(const Json& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_number_integer()) return json.get<long long>();
  if (json.is_number()) return json.get<double>();
  if (json.is_null()) return std::nan("");
  if (json.is_array()) {
    std::vector<double> out;
    for (const Json& one : json) out.push_back(one.is_null() ? std::nan("") : one.get<double>());
    return out;
  }
  return json.get<std::string>();
}

Json json_of(const Provenance& p) {
  Json libraries = Json::object();
  for (const auto& [name, version] : p.libraries) libraries[name] = version;
  return {{"version", p.version},       {"commit", p.commit},     {"compiler", p.compiler},
          {"build_type", p.build_type}, {"libraries", libraries}, {"cpu", p.cpu},
          {"cores", p.cores},           {"system", p.system},     {"started_utc", p.started_utc}};
}

Provenance provenance_of(const Json& json) {
  Provenance p{json.at("version"), json.at("commit"), json.at("compiler"), json.at("build_type"), {},
               json.at("cpu"),     json.at("cores"),  json.at("system"),   json.at("started_utc")};
  for (const auto& [name, version] : json.at("libraries").items())
    p.libraries.emplace_back(name, version.get<std::string>());
  return p;
}

Summary summary_of(const Json& json) {
  Summary s{json.at("command"),
            json.at("scene"),
            json.at("scene_source"),
            json.at("overrides"),
            json.at("outcome"),
            json.at("message"),
            json.value("remarks", std::vector<std::string>{}),
            provenance_of(json.at("provenance")),
            {}};
  for (const auto& [name, values] : json.at("figures").items()) {
    SummarySection& section = s.section(name);
    for (const auto& [key, value] : values.items()) section.values.emplace_back(key, value_of(value));
  }
  return s;
}

}  // namespace

SummarySection& Summary::section(const std::string& name) {
  for (SummarySection& one : sections)
    if (one.name == name) return one;
  return sections.emplace_back(SummarySection{name, {}});
}

std::string to_json(const Summary& s) {
  Json figures = Json::object();
  for (const SummarySection& section : s.sections) {
    Json values = Json::object();
    for (const auto& [key, value] : section.values) values[key] = json_of(value);
    figures[section.name] = values;
  }
  const Json json = {{"command", s.command},
                     {"scene", s.scene},
                     {"outcome", s.outcome},
                     {"message", s.message},
                     {"remarks", s.remarks},
                     {"overrides", s.overrides},
                     {"figures", figures},
                     {"provenance", json_of(s.provenance)},
                     {"scene_source", s.scene_source}};
  // A path need not be UTF-8, but the file must be.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_summary(const std::string& path, const Summary& summary) {
  write_atomically(path, to_json(summary));
}

Summary read_summary(const std::string& path) {
  try {
    return summary_of(parse_json(read_file(path), path));
  } catch (const Json::exception& e) { fail("{}: is not a summary of palpate: {}", path, e.what()); }
}

}  // namespace palpate::store
