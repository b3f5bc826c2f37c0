#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/missing_outputs.h"
#include "cli/paths.h"
#include "cli/progress.h"
#include "cli/stop.h"
#include "options.h"
#include "palpate/core/error.h"
#include "report/run_report.h"
#include "report/table.h"
#include "store/atomic_file.h"
#include "validation.h"
#include "validation_pool.h"

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

std::vector<std::string> row(const ValidationCase& one, const Measurement& m) {
  return {one.name,
          m.quantity,
          fmt::format("{:.6g}", m.computed),
          fmt::format("{:.6g}", m.exact),
          fmt::format("{:.2e}", m.error),
          fmt::format("{:.0e}", m.bar),
          report::within_text(m.order, m.order_low, m.order_high),
          m.passed() ? "pass" : "FAIL"};
}

/// Converts a number to JSON, which has no NaN: a quantity that does not apply is null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json numbers(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(number(value));
  return out;
}

/// Returns null if nothing is refined.
Json to_json(const validation::Refinement& r) {
  if (r.size.empty()) return nullptr;
  Json out = {{"size_label", r.size_label}, {"size", numbers(r.size)}, {"error", numbers(r.error)}};
  if (!r.wall_s.empty()) out["wall_s"] = numbers(r.wall_s);
  return out;
}

Json to_json(const ValidationCase& one, const CaseEnd& end) {
  Json list = Json::array();
  for (const Measurement& m : end.measurements)
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
  return {{"name", one.name},     {"section", one.section}, {"summary", one.summary}, {"why", one.why},
          {"broken", end.broken}, {"wall_s", end.wall_s},   {"measurements", list}};
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

/// Returns a row with text only, as long as the rows with figures.
std::vector<std::string> row_of_words(const ValidationCase& one, const std::string& words) {
  return {one.name, words, "-", "-", "-", "-", "-", "FAIL"};
}

void take(const ValidationCase& one, const CaseEnd& end, Run& out) {
  for (const Measurement& m : end.measurements) out.rows.push_back(row(one, m));
  if (end.measurements.empty())
    out.rows.push_back(row_of_words(one, end.broken.empty() ? "nothing was measured" : end.broken));
  out.cases.push_back(to_json(one, end));
  if (!all_pass(end.measurements)) ++out.failed;
}

/// Records a run with a fault: a measurement that still passes with its physics broken is worthless, and a
/// case that throws measures nothing.
void take_fault(const CaseRun& run, const CaseEnd& end, Run& out) {
  const bool found = end.broken.empty() && run.fault->is_found(end.measurements);
  out.rows.push_back({run.one->name, run.fault->name, run.fault->fails,
                      found                ? "fails, as required"
                      : end.broken.empty() ? "STILL PASSES"
                                           : end.broken});
  if (!found) ++out.failed;
}

/// Returns one run per case, or one per fault of each case.
std::vector<CaseRun> runs_of(const std::vector<const ValidationCase*>& cases, bool with_faults) {
  std::vector<CaseRun> out;
  for (const ValidationCase* one : cases) {
    if (!with_faults) out.push_back({one});
    for (const validation::Fault& fault : one->faults)
      if (with_faults) out.push_back({one, &fault});
  }
  return out;
}

/// Prints one line per case: its section and the meaning of its figures.
void print_meanings(const std::vector<const ValidationCase*>& cases) {
  std::vector<std::vector<std::string>> rows;
  for (const ValidationCase* one : cases) rows.push_back({one->name, one->section, one->summary});
  fmt::print("{}\n", report::format_table({"case", "section", "description"}, rows));
}

void write_results(const Run& run, const std::string& folder, MissingOutputs& missing) {
  const std::string path = (std::filesystem::path(folder) / "validation.json").string();
  store::write_atomically(path, Json{{"cases", run.cases}}.dump(2) + "\n");
  const report::RunReport written = report::write_run_report(folder);
  fmt::print("written: {}, {}\n", path, written.page.string());
  report::add_missing(written, missing);
}

TaskFolder::Use use_of(const ValidateArguments& arguments) {
  TaskFolder::Use use{arguments.folder, arguments.fresh, false, "validation", {}};
  if (use.folder.empty() && (arguments.array.slurm || !arguments.array.tasks.empty()))
    use.folder = default_folder("validation");
  experiments::ArrayJob& job = use.job;
  job.command = job.name = job.subject = "validate";
  job.words = arguments.cases;
  if (arguments.slow) job.words.emplace_back("--slow");
  if (arguments.quick) job.words.emplace_back("--quick");
  if (arguments.inject_faults) job.words.emplace_back("--inject-faults");
  return use;
}

CaseEnds run_watched(const std::vector<CaseRun>& runs, const ValidateArguments& arguments,
                     const experiments::Place& place) {
  Progress progress("validating");
  progress(0.0);
  experiments::EngineOptions options;
  options.jobs = experiments::jobs_or_cores(arguments.jobs);
  options.stop = &stop_flag();
  options.progress = [&](double share, const std::string& ended) { progress(share, ended); };
  return run_cases(runs, place, options);
}

/// Prints the table, and returns the number of runs that ended.
std::size_t print_table(const std::vector<CaseRun>& runs, const std::vector<std::optional<CaseEnd>>& ends,
                        bool with_faults, Run& out) {
  std::vector<const ValidationCase*> ended;
  std::size_t done = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!ends[i]) continue;
    ++done;
    if (ended.empty() || ended.back() != runs[i].one) ended.push_back(runs[i].one);
    if (runs[i].fault)
      take_fault(runs[i], *ends[i], out);
    else
      take(*runs[i].one, *ends[i], out);
  }
  print_meanings(ended);
  using Headers = std::vector<std::string>;
  fmt::print("{}", report::format_table(with_faults ? Headers{"case", "fault", "measured by", "outcome"}
                                                    : Headers{"case", "quantity", "computed", "exact",
                                                              "error", "limit", "order", "verdict"},
                                        out.rows));
  return done;
}

}  // namespace

int validate(const ValidateArguments& arguments) {
  const std::vector<CaseRun> runs = runs_of(chosen(arguments), arguments.inject_faults);
  TaskFolder tasks(arguments.array, use_of(arguments));
  const auto [ends, outcome] = run_watched(runs, arguments, tasks.place());
  if (tasks.ends_early()) return tasks.end(outcome);
  TaskFolder::print_reused(outcome.reused);
  Run out;
  const std::size_t done = print_table(runs, ends, arguments.inject_faults, out);
  MissingOutputs missing;
  tasks.add_missing(outcome, missing);
  if (!tasks.folder().empty() && !arguments.inject_faults) write_results(out, tasks.folder(), missing);
  fmt::print("{} of {} {}{}\n", done - static_cast<std::size_t>(out.failed), done,
             arguments.inject_faults ? "faults make their cases fail" : "cases meet their acceptance limits",
             done < runs.size() ? fmt::format("; stopped before the other {}", runs.size() - done) : "");
  if (outcome.stopped) {
    fmt::print(stderr, "palpate: stopped{}\n",
               tasks.folder().empty() ? "" : "; the same command resumes from " + tasks.folder());
    return kExitStopped;
  }
  return missing.close(out.failed > 0 ? kExitError : 0);
}

int print_cases() {
  for (const ValidationCase& one : validation::validation_cases())
    fmt::print("{}\t{}{}\n", one.name, one.summary, one.slow ? " (slow)" : "");
  return 0;
}

}  // namespace palpate::cli
