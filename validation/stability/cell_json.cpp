#include "cell_json.h"

#include <cmath>

namespace palpate::stability {
namespace {

nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}
double number_of(const nlohmann::json& value) {
  return value.is_number() ? value.get<double>() : std::nan("");
}

nlohmann::ordered_json names_of(const Verdicts& verdicts) {
  auto list = nlohmann::ordered_json::array();
  for (int v = 0; v < kVerdicts; ++v)
    if (verdicts.has(static_cast<Verdict>(v))) list.push_back(to_string(static_cast<Verdict>(v)));
  return list;
}

Verdict verdict_of(const std::string& name) {
  int v = 0;
  while (v + 1 < kVerdicts && name != to_string(static_cast<Verdict>(v))) ++v;
  return static_cast<Verdict>(v);
}

}  // namespace

nlohmann::ordered_json cell_to_json(const StabilityCell& cell) {
  return {{"row", cell.row},
          {"sub_case", cell.sub_case},
          {"integrator", cell.integrator},
          {"verdict", to_string(cell.verdict)},
          {"expected", names_of(cell.expected)},
          {"as_expected", cell.as_expected()},
          {"figure", cell.figure},
          {"energy_gain", number(cell.gain)},
          {"error", number(cell.error)},
          {"reason", cell.reason},
          {"steps", cell.steps},
          {"cpu_s", cell.cpu_s}};
}

StabilityCell cell_from_json(const nlohmann::json& json) {
  StabilityCell cell;
  cell.row = json.at("row");
  cell.sub_case = json.at("sub_case");
  cell.integrator = json.at("integrator");
  cell.verdict = verdict_of(json.at("verdict"));
  for (const auto& name : json.at("expected")) cell.expected.add(verdict_of(name));
  cell.figure = json.at("figure");
  cell.gain = number_of(json.at("energy_gain"));
  cell.error = number_of(json.at("error"));
  cell.reason = json.at("reason");
  cell.steps = json.at("steps");
  cell.cpu_s = json.at("cpu_s");
  return cell;
}

}  // namespace palpate::stability
