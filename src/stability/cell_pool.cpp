#include <nlohmann/json.hpp>
#include <optional>

#include "cell_json.h"
#include "cell_runner.h"
#include "palpate/core/error.h"
#include "palpate/core/process_pool.h"

namespace palpate::stability {
namespace {

/// The cell that a process sent, or what its end says of it.
StabilityCell cell_of(const Task& task, const ProcessPool::Outcome& outcome) {
  using End = ProcessPool::Outcome::End;
  if (outcome.end == End::kDone) return cell_from_json(nlohmann::json::parse(outcome.bytes));
  StabilityCell cell;
  cell.row = task.row->name;
  cell.sub_case = task.sub_case->name;
  cell.integrator = task.column->label;
  cell.verdict = outcome.end == End::kOutOfTime ? Verdict::kTooSlow : Verdict::kSilent;
  cell.reason = outcome.end == End::kOutOfTime ? "cut off: " + outcome.bytes : outcome.bytes;
  return cell;
}

}  // namespace

std::vector<StabilityCell> run_cells(const std::vector<Task>& tasks, const StabilityOptions& options) {
  std::vector<std::optional<StabilityCell>> cells(tasks.size());
  std::size_t done = 0, next = 0;
  ProcessPool pool(options.jobs);
  const auto stopped = [&] { return options.stop && options.stop->load(); };
  const auto start = [&](std::size_t index) {
    const Task& task = tasks[index];
    const double limit_s = (task.row->slow ? kLongerInSlowRows : 1.0) * options.limit_s;
    pool.start(
        [&task, &options, limit_s](const std::atomic<bool>& expired) {
          return cell_to_json(run_cell(task, options.seeds, limit_s, expired)).dump();
        },
        limit_s,
        [&, index](const ProcessPool::Outcome& outcome) {
          cells[index] = cell_of(tasks[index], outcome);
          ++done;
          if (options.progress)
            options.progress(static_cast<double>(done) / static_cast<double>(tasks.size()),
                             fmt::format("{}, {}", cells[index]->row, cells[index]->integrator));
        });
  };
  while (true) {
    while (next < tasks.size() && pool.has_room() && !stopped()) start(next++);
    if (pool.idle()) break;
    pool.wait(0.5);
  }
  std::vector<StabilityCell> out;
  for (auto& cell : cells)
    if (cell) out.push_back(std::move(*cell));
  return out;
}

}  // namespace palpate::stability
