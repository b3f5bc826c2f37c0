#include "study.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <numeric>

#include "cli/missing_outputs.h"
#include "cli/paths.h"
#include "cli/progress.h"
#include "cli/stop.h"
#include "core/clock.h"
#include "experiments/indices.h"
#include "experiments/study/results.h"
#include "experiments/study/run.h"
#include "model_cache.h"
#include "palpate/core/error.h"
#include "report/run_report.h"
#include "report/table.h"
#include "store/summary.h"

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;
using study::Plan;
using study::Results;
using study::Row;
using study::Task;

constexpr std::size_t kMostRows = 60;  ///< Most rows of a table on the terminal
/// Figures shown on the terminal; study.csv has all.
const std::vector<std::string> kShown = {"steps", "peak_force_n", "largest_displacement_m"};

std::string command_of(const StudyArguments& a) {
  std::string out = "palpate study " + a.study;
  if (!a.folder.empty()) out += " -o " + a.folder;
  return out;
}

/// Returns the columns whose cells are not all the same: the table of a study of one scene does not repeat
/// its name in every row.
std::vector<std::size_t> varying(const Results& results) {
  std::vector<std::size_t> out;
  for (std::size_t c = 0; c < results.settings.size(); ++c)
    if (std::any_of(results.rows.begin(), results.rows.end(),
                    [&](const Row& row) { return row.settings[c] != results.rows[0].settings[c]; }))
      out.push_back(c);
  return out;
}

const std::string& cell_at(const std::vector<std::string>& names, const std::vector<std::string>& cells,
                           const std::string& name) {
  static const std::string none;
  const auto at = std::find(names.begin(), names.end(), name);
  return at == names.end() ? none : cells[static_cast<std::size_t>(at - names.begin())];
}

void print_results(const Results& results) {
  const std::vector<std::size_t> settings = varying(results);
  std::vector<std::string> headers = {"task"}, shown;
  for (const std::size_t c : settings) headers.push_back(results.settings[c]);
  headers.emplace_back("status");
  for (const std::string& one : kShown)
    if (std::find(results.figures.begin(), results.figures.end(), one) != results.figures.end())
      shown.push_back(one);
  headers.insert(headers.end(), shown.begin(), shown.end());
  headers.emplace_back("CPU [s]");
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < std::min(kMostRows, results.rows.size()); ++i) {
    const Row& row = results.rows[i];
    std::vector<std::string>& cells = rows.emplace_back();
    cells.push_back(std::to_string(i));
    for (const std::size_t c : settings) cells.push_back(row.settings[c]);
    cells.push_back(row.status);
    for (const std::string& one : shown)
      cells.push_back(report::short_cell(cell_at(results.figures, row.figures, one)));
    cells.push_back(report::short_cell(cell_at(results.times, row.times, "loop_cpu_s")));
  }
  fmt::print("{}", report::format_table(headers, rows));
  if (results.rows.size() > kMostRows)
    fmt::print("... and {} more; study.csv lists all\n", results.rows.size() - kMostRows);
}

/// All ways in which a task may end, as study.csv names them.
constexpr std::array kStatuses = {"ok", "failed", "out of time", "crashed", "refused", "missing"};

std::string counts_of(const Results& results) {
  std::string out;
  for (const char* status : kStatuses)
    if (const std::size_t n = results.count(status); n > 0)
      out += fmt::format("{}{} {}", out.empty() ? "" : ", ", n, status);
  return out;
}

/// Prints the first reason for each status other than "ok".
void print_reasons(const Results& results) {
  for (const char* status : {"failed", "out of time", "crashed", "refused"}) {
    const auto at = std::find_if(results.rows.begin(), results.rows.end(),
                                 [&](const Row& row) { return row.status == status; });
    if (at == results.rows.end()) continue;
    fmt::print("{}: task {}: {}\n", status, at - results.rows.begin(), at->reason);
  }
}

void print_plan(const Plan& plan) {
  std::vector<std::string> headers = {"task", "scene", "integrator", "rtol", "step_s"};
  for (const auto& [name, value] : plan.tasks[0].varied) headers.push_back(name);
  headers.emplace_back("key");
  std::vector<std::vector<std::string>> rows;
  for (const Task& task : plan.tasks) {
    std::vector<std::string>& row = rows.emplace_back(std::vector<std::string>{
        std::to_string(task.index), plan.scenes[task.scene].name, task.integrator, task.rtol, task.step_s});
    for (const auto& [name, value] : task.varied) row.push_back(value);
    row.push_back(task.refused.empty() ? task.key : "refused: " + task.refused);
  }
  fmt::print("{}{} tasks\n", report::format_table(headers, rows), plan.tasks.size());
}

study::PlanHelp help_of() { return {find_scene, make_missing_models}; }

std::vector<std::size_t> all_of(const Plan& plan) {
  std::vector<std::size_t> out(plan.tasks.size());
  std::iota(out.begin(), out.end(), std::size_t{0});
  return out;
}

study::RunOutcome run_watched(Plan& plan, const std::vector<std::size_t>& tasks,
                              const StudyArguments& arguments, TaskFolder& folder) {
  Progress progress("running " + plan.spec.name);
  experiments::EngineOptions options;
  options.jobs = arguments.jobs;
  options.submit = folder.place().submit;
  options.stop = &stop_flag();
  options.progress = [&progress](double fraction, const std::string& what) { progress(fraction, what); };
  return study::run_tasks(plan, tasks, help_of(), folder.store(), options);
}

std::string why_lost(const study::RunOutcome& outcome) {
  if (outcome.lost.empty()) return "not run yet; the same command without --merge runs them";
  const experiments::LostTask& first = outcome.lost.front();
  return fmt::format("task {}: {}; the same command runs {} again", first.index, first.why,
                     outcome.lost.size() == 1 ? "it" : "them");
}

TaskFolder::Use use_of(const Plan& plan, const StudyArguments& arguments, const std::string& folder) {
  TaskFolder::Use out{folder, arguments.fresh, arguments.merge, "study", {}};
  out.job.command = "study";
  out.job.words = {plan.spec.path};
  out.job.name = plan.spec.name;
  out.job.subject = plan.spec.path;
  out.hint = fmt::format("  palpate study {} -o {} --merge        makes the table of the results so far\n",
                         arguments.study, folder);
  return out;
}

/// Adds a parameter whose values are spaced by equal ratios.
void add_log_spaced(store::Summary& summary, const std::string& key) {
  summary.list("log_spaced_parameters").push_back({{"key", key}});
}

void keep_summary(const Plan& plan, const Results& results, const StudyArguments& arguments, bool stopped,
                  double wall_s, const std::string& folder) {
  store::Summary summary;
  summary.command = command_of(arguments);
  summary.scene = plan.spec.name;
  summary.outcome = stopped ? "interrupted" : "finished";
  summary.provenance = store::provenance();
  store::SummaryFields& counts = summary.section("tasks").values;
  counts.emplace_back("total", static_cast<long long>(results.rows.size()));
  for (const char* status : kStatuses) {
    std::string key = status;
    std::replace(key.begin(), key.end(), ' ', '_');
    counts.emplace_back(key, static_cast<long long>(results.count(status)));
  }
  summary.section("timings").values = {{"wall_s", wall_s}};
  for (const scene::SweepSpec& sweep : plan.spec.sweeps)
    if (sweep.spacing == scene::Spacing::kLog) add_log_spaced(summary, sweep.key);
  for (const scene::RandomSpec& random : plan.spec.randoms)
    if (random.distribution == scene::Distribution::kLogUniform) add_log_spaced(summary, random.key);
  store::write_summary((fs::path(folder) / "summary.json").string(), summary);
}

}  // namespace

int study(const StudyArguments& arguments) {
  const double start = wall_seconds();
  const scene::StudySpec spec = scene::load_study(arguments.study);
  const std::string folder = arguments.folder.empty()
                                 ? default_folder("study-" + fs::path(arguments.study).stem().string())
                                 : arguments.folder;
  Plan plan = study::list_tasks(spec, help_of());
  check_plan(arguments.array, plan.key, arguments.study, "study");
  if (!arguments.array.tasks.empty()) {
    const auto some = experiments::indices_of(arguments.array.tasks, plan.tasks.size());
    TaskFolder tasks(arguments.array, use_of(plan, arguments, folder));
    const study::RunOutcome outcome = run_watched(plan, some, arguments, tasks);
    return tasks.end(outcome, static_cast<long>(outcome.refused));
  }
  study::settle_all(plan, help_of());
  if (arguments.dry_run) {
    print_plan(plan);
    return 0;
  }
  TaskFolder tasks(arguments.array, use_of(plan, arguments, folder));
  study::RunOutcome outcome;
  if (!arguments.merge) outcome = run_watched(plan, all_of(plan), arguments, tasks);
  if (tasks.ends_early()) return tasks.end(outcome);
  if (!arguments.array.slurm) TaskFolder::print_reused(outcome.reused);

  const Results results = study::merge(plan, tasks.store());
  study::write(plan, results, folder);
  keep_summary(plan, results, arguments, outcome.stopped, wall_seconds() - start, folder);
  print_results(results);
  print_reasons(results);
  const report::RunReport written = report::write_run_report(folder);
  fmt::print("\nwritten: {0}/study.csv, {0}/study-times.csv, {1}\n", folder, written.page.string());
  fmt::print("{} tasks: {}\n", results.rows.size(), counts_of(results));
  if (outcome.stopped) {
    fmt::print(stderr, "palpate: stopped; the same command resumes from {}\n", folder);
    return kExitStopped;
  }
  MissingOutputs missing;
  if (!results.missing.empty())
    missing.add(fmt::format("result of task{} {}", results.missing.size() == 1 ? "" : "s",
                            experiments::text_of(results.missing)),
                arguments.array.slurm ? tasks.lost() : why_lost(outcome));
  report::add_missing(written, missing);
  return missing.close(0);
}

}  // namespace palpate::cli
