#include <nlohmann/json.hpp>
#include <optional>

#include "cell_json.h"
#include "cell_runner.h"
#include "core/bytes.h"
#include "core/process_pool.h"
#include "palpate/core/error.h"
#include "palpate/integrate/integrators.h"

namespace palpate::stability {
namespace {

/// Returns the cell sent by a process, or a cell that describes the way in which the process ended.
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

/// Encodes a cell as bytes for a process that has no access to this matrix except its rows, which are
/// constant.
std::string encode_job(const Task& task, const StabilityOptions& options, double limit_s) {
  const auto registry = options.registry ? options.registry : &integrate::stepper_registry;
  ByteWriter out;
  out.put(task.row->name).put(task.sub_case->name).put(task.column->label);
  out.put(options.seeds).put(limit_s).put(reinterpret_cast<std::uintptr_t>(registry));
  return out.take();
}

template <typename Named>
const Named& named(const std::vector<Named>& all, std::string Named::*name, const std::string& requested) {
  for (const Named& one : all)
    if (one.*name == requested) return one;
  fail("the process of a cell got an unknown cell \"{}\"", requested);
}

/// A ProcessPool::Work: runs the cell encoded by encode_job().
std::string run_job(const std::string& order, const std::atomic<bool>& expired) {
  ByteReader in(order);
  const auto row_name = in.get<std::string>(), case_name = in.get<std::string>(),
             label = in.get<std::string>();
  const int seeds = in.get<int>();
  const double limit_s = in.get<double>();
  const auto registry = reinterpret_cast<const dynamics::StepperRegistry& (*)()>(in.get<std::uintptr_t>());
  const std::vector<Row> rows = all_rows();
  const Row& row = named(rows, &Row::name, row_name);
  const std::vector<Column> columns = columns_of(row, registry());
  const Task task{&row, &named(row.cases, &SubCase::name, case_name), &named(columns, &Column::label, label)};
  return cell_to_json(run_cell(task, seeds, limit_s, expired)).dump();
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
    pool.start(run_job, encode_job(task, options, limit_s), limit_s,
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
