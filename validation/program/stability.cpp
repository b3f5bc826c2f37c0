#include "stability/stability.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "cli/missing_outputs.h"
#include "cli/paths.h"
#include "cli/progress.h"
#include "cli/stop.h"
#include "options.h"
#include "report/run_report.h"
#include "report/table.h"

namespace palpate::cli {
namespace {

using stability::StabilityCell;
using stability::Verdict;

/// Returns one letter per cell, so that the matrix fits a terminal.
char letter(const StabilityCell& cell) { return "ASBEGNFTW"[static_cast<std::size_t>(cell.verdict)]; }

/// Prints one row of letters per case, one column per integrator; marks cells that differ from the
/// expectation.
void print_matrix(const stability::StabilityMatrix& matrix) {
  std::vector<std::string> integrators;
  std::vector<std::pair<std::string, std::map<std::string, std::string>>> rows;
  for (const StabilityCell& cell : matrix.cells) {
    if (std::find(integrators.begin(), integrators.end(), cell.integrator) == integrators.end())
      integrators.push_back(cell.integrator);
    const std::string name = fmt::format("{}: {}", cell.row, cell.sub_case);
    if (rows.empty() || rows.back().first != name) rows.push_back({name, {}});
    rows.back().second[cell.integrator] = fmt::format("{}{}", letter(cell), cell.as_expected() ? ' ' : '!');
  }
  for (std::size_t i = 0; i < integrators.size(); ++i) fmt::print("{:>3}  {}\n", i + 1, integrators[i]);
  std::size_t width = 0;
  for (const auto& row : rows) width = std::max(width, row.first.size());
  fmt::print("\n{:{}}", "", width);
  for (std::size_t i = 0; i < integrators.size(); ++i) fmt::print(" {:>2}", i + 1);
  fmt::print("\n");
  for (const auto& [name, cells] : rows) {
    std::string line = fmt::format("{:{}}", name, width);
    for (const std::string& integrator : integrators)
      line += "  " + (cells.contains(integrator) ? cells.at(integrator) : ". ");
    fmt::print("{}\n", line.substr(0, line.find_last_not_of(' ') + 1));
  }
  fmt::print(
      "\nA accurate  S stable  B bounded  E ended with a clear error message  G grew  N not finite  F failed "
      "without a reason  T too slow  W wrong  ! unexpected  . not applicable\n");
}

void print_cells(const stability::StabilityMatrix& matrix, bool only_unexpected) {
  std::vector<std::vector<std::string>> rows;
  for (const StabilityCell& c : matrix.cells)
    if (!only_unexpected || !c.as_expected())
      rows.push_back({c.row, c.sub_case, c.integrator, stability::to_string(c.verdict), c.expected.text(),
                      c.figure, fmt::format("{:.2f}", c.cpu_s), c.reason});
  if (!rows.empty())
    fmt::print("\n{}", report::format_table({"row", "case", "integrator", "verdict", "expected", "figure",
                                             "CPU [s]", "reason"},
                                            rows));
}

std::string command_of(const StabilityArguments& arguments) {
  std::string command = "palpate stability";
  for (const std::string& row : arguments.rows) command += " --row " + row;
  for (const std::string& integrator : arguments.integrators) command += " --integrator " + integrator;
  if (arguments.slow) command += " --slow";
  return command + fmt::format(" --seeds {} --jobs {} --limit-s {:g}", arguments.seeds, arguments.jobs,
                               arguments.limit_s);
}

TaskFolder::Use use_of(const StabilityArguments& arguments, const std::string& folder) {
  TaskFolder::Use use{folder, arguments.fresh, false, "matrix", {}};
  experiments::ArrayJob& job = use.job;
  job.command = job.name = job.subject = "stability";
  for (const std::string& row : arguments.rows) job.words.insert(job.words.end(), {"--row", row});
  for (const std::string& name : arguments.integrators)
    job.words.insert(job.words.end(), {"--integrator", name});
  if (arguments.slow) job.words.emplace_back("--slow");
  job.words.insert(job.words.end(), {"--seeds", fmt::format("{}", arguments.seeds), "--limit-s",
                                     fmt::format("{}", arguments.limit_s)});
  return use;
}

stability::StabilityMatrix watched(const StabilityArguments& arguments, const experiments::Place& place) {
  Progress progress("stability");
  stability::StabilityOptions options;
  options.rows = arguments.rows;
  options.integrators = arguments.integrators;
  options.slow = arguments.slow;
  options.seeds = arguments.seeds;
  options.jobs = arguments.jobs;
  options.limit_s = arguments.limit_s;
  options.progress = [&progress](double fraction, const std::string& what) { progress(fraction, what); };
  options.stop = &stop_flag();
  options.place = place;
  return stability::run(options);
}

}  // namespace

int stability(const StabilityArguments& arguments) {
  const std::string folder = arguments.folder.empty() ? default_folder("stability") : arguments.folder;
  TaskFolder tasks(arguments.array, use_of(arguments, folder));
  const stability::StabilityMatrix matrix = watched(arguments, tasks.place());
  if (tasks.ends_early()) return tasks.end(matrix.outcome);
  TaskFolder::print_reused(matrix.outcome.reused);
  stability::write(matrix, folder, command_of(arguments));
  print_matrix(matrix);
  print_cells(matrix, !arguments.cells);
  const long unexpected = matrix.unexpected();
  const report::RunReport written = report::write_run_report(folder);
  fmt::print("\nwritten: {}\n", written.page.string());
  fmt::print("{} of {} cells agree with theory, in {:.0f} s\n",
             static_cast<long>(matrix.cells.size()) - unexpected, matrix.cells.size(), matrix.wall_s);
  if (matrix.outcome.stopped) {
    fmt::print(stderr, "palpate: stopped; the finished cells are in {}\n", folder);
    return kExitStopped;
  }
  MissingOutputs missing;
  report::add_missing(written, missing);
  tasks.add_missing(matrix.outcome, missing);
  return missing.close(unexpected > 0 ? kExitError : 0);
}

}  // namespace palpate::cli
