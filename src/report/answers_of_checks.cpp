#include <algorithm>
#include <cmath>

#include "answers.h"
#include "palpate/core/error.h"

namespace palpate::report {
namespace {

/// Returns a count with its noun: "1 thread", "2 threads".
std::string counted(double n, const char* noun) {
  return fmt::format("{} {}{}", short_number(n, 15), noun, n == 1.0 ? "" : "s");
}

constexpr std::size_t kMostNamed = 5;  ///< Most failures that are listed by name

std::string named(const std::vector<std::string>& names) {
  const std::size_t shown = std::min(kMostNamed, names.size());
  std::string out =
      fmt::format("{}", fmt::join(names.begin(), names.begin() + static_cast<long>(shown), "; "));
  return names.size() > shown ? fmt::format("{}; and {} more", out, names.size() - shown) : out;
}

}  // namespace

Answer validation_answer(const Json& validation) {
  Answer out;
  const Json& cases =
      validation.is_object() && validation.contains("cases") ? validation["cases"] : validation;
  if (!cases.is_array() || cases.empty()) return out;
  std::size_t measurements = 0;
  std::vector<std::string> failed;
  double closest = 0.0;
  std::string closest_name;
  for (const Json& one : cases) {
    if (!one.is_object() || !one.contains("measurements")) continue;
    const std::string name = text_at(one, "name");
    if (one["measurements"].empty()) failed.push_back(name + ": nothing was measured");
    for (const Json& m : one["measurements"]) {
      ++measurements;
      const std::string what = name + ", " + text_at(m, "quantity");
      if (!m.value("passed", false)) failed.push_back(what);
      if (const double share = number_at(m, "error") / number_at(m, "bar"); share <= 1.0 && share > closest)
        closest = share, closest_name = what;
    }
  }
  if (failed.empty())
    out.lead = fmt::format(
        "The library agrees with theory: {} of {} meet{} the acceptance limit.",
        measurements == 1 ? "the one measurement" : fmt::format("all {} measurements", measurements),
        counted(static_cast<double>(cases.size()), "case"), measurements == 1 ? "s" : "");
  else
    out.lead = fmt::format("{} of {} measurements are outside their acceptance limits.", failed.size(),
                           measurements);
  if (!failed.empty()) out.points.push_back("They are: " + named(failed) + ".");
  if (closest >= 0.01)
    out.points.push_back(
        fmt::format("Among the passing measurements, the closest to its acceptance limit is {}: its error is "
                    "{:.0f} % of the limit.",
                    closest_name, 100.0 * closest));
  else if (measurements > failed.size())
    out.points.push_back("All passing measurements have errors below 1 % of their acceptance limits.");
  return out;
}

Answer stability_answer(const Json& stability) {
  Answer out;
  if (!stability.is_object() || !stability.contains("cells") || !stability["cells"].is_array() ||
      stability["cells"].empty())
    return out;
  const Json& cells = stability["cells"];
  std::vector<std::string> odd, verdicts;
  std::map<std::string, long> count;
  for (const Json& cell : cells) {
    const std::string verdict = text_at(cell, "verdict");
    if (count[verdict]++ == 0) verdicts.push_back(verdict);
    if (!cell.value("as_expected", false))
      odd.push_back(fmt::format("{}, {}: {} is {}", text_at(cell, "row"), text_at(cell, "sub_case"),
                                text_at(cell, "integrator"), verdict));
  }
  if (odd.empty())
    out.lead = fmt::format("All {} cells end as theory predicts.", cells.size());
  else
    out.lead = fmt::format("{} of {} cells do not end as theory predicts.", odd.size(), cells.size());
  if (!odd.empty()) out.points.push_back("They are: " + named(odd) + ".");
  std::string how;
  for (const std::string& verdict : verdicts)
    how += fmt::format("{}{} {}", how.empty() ? "" : ", ", count[verdict], verdict);
  out.points.push_back("Cells by verdict: " + how + ".");
  return out;
}

Answer bench_answer(const Json& bench) {
  Answer out;
  if (bench.contains("rows") && bench["rows"].is_array()) {
    std::vector<std::pair<std::string, const Json*>> fastest;
    for (const Json& row : bench["rows"]) {
      const std::string what = fmt::format("{}, steps of {} ms", counted(number_at(row, "nodes"), "node"),
                                           short_number(1e3 * number_at(row, "step_s")));
      const auto known =
          std::find_if(fastest.begin(), fastest.end(), [&](const auto& f) { return f.first == what; });
      if (known == fastest.end())
        fastest.emplace_back(what, &row);
      else if (number_at(row, "step_ms") < number_at(*known->second, "step_ms"))
        known->second = &row;
    }
    if (!fastest.empty()) {
      out.lead = "How long does one implicit step take? Fastest solver for each size:";
      out.asks = true;
    }
    for (const auto& [what, row] : fastest)
      out.points.push_back(
          fmt::format("{}: {} ms by {} on {}.", what, short_number(number_at(*row, "step_ms")),
                      text_at(*row, "linear_solver"), counted(number_at(*row, "threads"), "thread")));
  }
  if (bench.contains("bars") && bench["bars"].is_array() && !bench["bars"].empty()) {
    std::vector<std::string> missed;
    for (const Json& bar : bench["bars"])
      if (!bar.value("met", false)) missed.push_back(text_at(bar, "scene") + ", " + text_at(bar, "what"));
    out.lead = missed.empty()
                   ? fmt::format("All {} figures meet their acceptance limits.", bench["bars"].size())
                   : fmt::format("{} of {} figures are outside their acceptance limits.", missed.size(),
                                 bench["bars"].size());
    if (!missed.empty()) out.points.push_back("They are: " + named(missed) + ".");
  }
  return out;
}

}  // namespace palpate::report
