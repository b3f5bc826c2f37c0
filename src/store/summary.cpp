#include "store/summary.h"

#include <algorithm>
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
  if (!json.is_array()) return json.get<std::string>();
  const auto all = [&json](const auto& test) {
    return !json.empty() && std::all_of(json.begin(), json.end(), test);
  };
  if (all([](const Json& one) { return one.is_string(); })) return json.get<std::vector<std::string>>();
  if (all([](const Json& one) { return one.is_number_integer(); })) return json.get<std::vector<long long>>();
  std::vector<double> out;
  for (const Json& one : json) out.push_back(one.is_null() ? std::nan("") : one.get<double>());
  return out;
}

Json json_of(const SummaryFields& fields) {
  Json out = Json::object();
  for (const auto& [key, value] : fields) out[key] = json_of(value);
  return out;
}

SummaryFields fields_of(const Json& json) {
  SummaryFields out;
  for (const auto& [key, value] : json.items()) out.emplace_back(key, value_of(value));
  return out;
}

Json json_of(const Provenance& p) {
  Json libraries = Json::array();
  for (const auto& [name, version] : p.libraries) libraries.push_back({{"name", name}, {"version", version}});
  return {{"version", p.version},       {"commit", p.commit},     {"compiler", p.compiler},
          {"build_type", p.build_type}, {"libraries", libraries}, {"cpu", p.cpu},
          {"cores", p.cores},           {"system", p.system},     {"started_utc", p.started_utc}};
}

Provenance provenance_of(const Json& json) {
  Provenance p{json.at("version"), json.at("commit"), json.at("compiler"), json.at("build_type"), {},
               json.at("cpu"),     json.at("cores"),  json.at("system"),   json.at("started_utc")};
  for (const Json& library : json.at("libraries"))
    p.libraries.emplace_back(library.at("name").get<std::string>(), library.at("version").get<std::string>());
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
            {},
            {}};
  for (const auto& [name, figures] : json.at("figures").items()) {
    if (!figures.is_array())
      s.section(name).values = fields_of(figures);
    else
      for (const Json& row : figures) s.list(name).push_back(fields_of(row));
  }
  return s;
}

}  // namespace

SummarySection& Summary::section(const std::string& name) {
  for (SummarySection& one : sections)
    if (one.name == name) return one;
  return sections.emplace_back(SummarySection{name, {}});
}

std::vector<SummaryFields>& Summary::list(const std::string& name) {
  for (SummaryList& one : lists)
    if (one.name == name) return one.rows;
  return lists.emplace_back(SummaryList{name, {}}).rows;
}

std::string to_json(const Summary& s) {
  Json figures = Json::object();
  for (const SummarySection& section : s.sections) figures[section.name] = json_of(section.values);
  for (const SummaryList& list : s.lists) {
    Json& rows = figures[list.name] = Json::array();
    for (const SummaryFields& row : list.rows) rows.push_back(json_of(row));
  }
  const Json json = {{"schema_version", kSummarySchema},
                     {"command", s.command},
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
    const Json json = parse_json(read_file(path), path);
    if (const int schema = json.at("schema_version"); schema != kSummarySchema)
      fail("{}: schema_version is {}, and this version of palpate reads {}", path, schema, kSummarySchema);
    return summary_of(json);
  } catch (const Json::exception& e) { fail("{}: is not a summary of palpate: {}", path, e.what()); }
}

}  // namespace palpate::store
