#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "palpate/core/clock.h"
#include "palpate/core/error.h"
#include "palpate/report/run_report.h"
#include "palpate/report/table.h"
#include "palpate/store/atomic_file.h"
#include "palpate/store/result_folder.h"
#include "palpate/validation/validation.h"
#include "paths.h"
#include "progress.h"
#include "stop.h"
#include "undelivered.h"

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;
using validation::Measurement;
using validation::ValidationCase;

std::vector<const ValidationCase*> chosen(const ValidateArguments& arguments) {
  std::vector<std::string> known;
  for (const ValidationCase& one : validation::validation_cases()) known.push_back(one.name);
  std::vector<const ValidationCase*> out;
  for (const std::string& name : arguments.cases) {
    const auto at = std::find(known.begin(), known.end(), name);
    if (at == known.end())
      fail("there is no case \"{}\"{}; see `palpate list cases`", name, suggestion(name, known));
    out.push_back(&validation::validation_cases()[static_cast<std::size_t>(at - known.begin())]);
  }
  if (arguments.cases.empty())
    for (const ValidationCase& one : validation::validation_cases())
      if (arguments.quick ? one.quick : !one.slow || arguments.slow) out.push_back(&one);
  return out;
}

std::string order_text(const Measurement& m) {
  if (std::isnan(m.order)) return "-";
  if (std::isnan(m.order_low)) return fmt::format("{:.2f}", m.order);
  return fmt::format("{:.2f} in [{:g}, {:g}]", m.order, m.order_low, m.order_high);
}

std::vector<std::string> row(const ValidationCase& one, const Measurement& m) {
  return {one.name,
          m.quantity,
          fmt::format("{:.6g}", m.computed),
          fmt::format("{:.6g}", m.exact),
          fmt::format("{:.2e}", m.error),
          fmt::format("{:.0e}", m.bar),
          order_text(m),
          m.passed() ? "pass" : "FAIL"};
}

/// JSON has no NaN: what does not apply is null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json numbers(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(number(value));
  return out;
}

/// Null where nothing is refined.
Json to_json(const validation::Refinement& r) {
  if (r.size.empty()) return nullptr;
  Json out = {{"size_label", r.size_label}, {"size", numbers(r.size)}, {"error", numbers(r.error)}};
  if (!r.wall_s.empty()) out["wall_s"] = numbers(r.wall_s);
  return out;
}

Json to_json(const ValidationCase& one, const std::vector<Measurement>& measurements, double seconds) {
  Json list = Json::array();
  for (const Measurement& m : measurements)
    list.push_back({{"quantity", m.quantity},
                    {"computed", number(m.computed)},
                    {"exact", number(m.exact)},
                    {"error", number(m.error)},
                    {"bar", number(m.bar)},
                    {"order", number(m.order)},
                    {"order_low", number(m.order_low)},
                    {"order_high", number(m.order_high)},
                    {"note", m.note},
                    {"refinement", to_json(m.refinement)},
                    {"passed", m.passed()}});
  return {{"name", one.name}, {"section", one.section}, {"summary", one.summary},
          {"why", one.why},   {"wall_s", seconds},      {"measurements", list}};
}

bool all_pass(const std::vector<Measurement>& measurements) {
  return !measurements.empty() && std::all_of(measurements.begin(), measurements.end(),
                                              [](const Measurement& m) { return m.passed(); });
}

struct Run {
  std::vector<std::vector<std::string>> rows;
  Json cases = Json::array();
  int failed = 0;
};

void run_one(const ValidationCase& one, Run& out) {
  const double start = wall_seconds();
  const std::vector<Measurement> measurements = one.run("");
  for (const Measurement& m : measurements) out.rows.push_back(row(one, m));
  if (measurements.empty())
    out.rows.push_back({one.name, "nothing was measured", "-", "-", "-", "-", "-", "FAIL"});
  out.cases.push_back(to_json(one, measurements, wall_seconds() - start));
  if (!all_pass(measurements)) ++out.failed;
}

/// Runs a case with each of its faults: a measurement that still passes with its physics broken is worthless.
void run_with_faults(const ValidationCase& one, Run& out) {
  bool all_found = true;
  for (const validation::Fault& fault : one.faults) {
    const bool found = fault.is_found(one.run(fault.name));
    out.rows.push_back({one.name, fault.name, fault.fails, found ? "fails, as it must" : "STILL PASSES"});
    all_found = all_found && found;
  }
  if (!all_found) ++out.failed;
}

/// A line a case: its section, and what its figures mean.
void print_meanings(const std::vector<const ValidationCase*>& cases) {
  std::vector<std::vector<std::string>> rows;
  for (const ValidationCase* one : cases) rows.push_back({one->name, one->section, one->summary});
  fmt::print("{}\n", report::format_table({"case", "section", "what it measures"}, rows));
}

void write_results(const Run& run, const std::string& folder, Undelivered& missing) {
  const store::ResultFolder mine(folder);
  const std::string path = (std::filesystem::path(folder) / "validation.json").string();
  store::write_atomically(path, Json{{"cases", run.cases}}.dump(2) + "\n");
  const report::RunReport written = report::write_run_report(folder);
  fmt::print("written: {}, {}\n", path, written.page.string());
  missing.add(written);
}

}  // namespace

int validate(const ValidateArguments& arguments) {
  const std::vector<const ValidationCase*> cases = chosen(arguments);
  Run out;
  std::size_t done = 0;
  {
    Progress progress("validating");
    for (const ValidationCase* one : cases) {
      if (stop_flag()) break;
      progress(static_cast<double>(done) / static_cast<double>(cases.size()), one->name);
      arguments.inject_faults ? run_with_faults(*one, out) : run_one(*one, out);
      ++done;
    }
  }
  print_meanings({cases.begin(), cases.begin() + static_cast<std::ptrdiff_t>(done)});
  using Headers = std::vector<std::string>;
  fmt::print("{}",
             report::format_table(arguments.inject_faults ? Headers{"case", "fault", "measured by", "outcome"}
                                                          : Headers{"case", "quantity", "computed", "exact",
                                                                    "error", "bar", "order", "verdict"},
                                  out.rows));
  Undelivered missing;
  if (!arguments.folder.empty() && !arguments.inject_faults) write_results(out, arguments.folder, missing);
  fmt::print("{} of {} cases {}{}\n", done - static_cast<std::size_t>(out.failed), done,
             arguments.inject_faults ? "fail when broken on purpose" : "keep their bars",
             done < cases.size() ? fmt::format("; stopped before the other {}", cases.size() - done) : "");
  return missing.close(out.failed > 0 ? kExitError : 0);
}

}  // namespace palpate::cli
