#include <cmath>
#include <optional>

#include "cell_runner.h"
#include "core/archive_bytes.h"
#include "palpate/core/error.h"
#include "palpate/integrate/integrators.h"

namespace palpate::stability {
namespace {

using Registry = const dynamics::StepperRegistry& (*)();

/// Input of a cell's process, which has no access to the matrix except its rows, which are constant.
struct Job {
  std::string row, sub_case, column;
  int seeds = 0;
  double limit_s = 0.0;
  Registry registry = nullptr;

  void archive(Archive& a) {
    a("row", row);
    a("sub_case", sub_case);
    a("column", column);
    a("seeds", seeds);
    a("limit_s", limit_s);
    a.bytes("registry", registry);
  }
};

template <typename Named>
const Named& named(const std::vector<Named>& all, std::string Named::*name, const std::string& requested) {
  for (const Named& one : all)
    if (one.*name == requested) return one;
  fail("the process of a cell got an unknown cell \"{}\"", requested);
}

/// A ProcessPool::Work: runs one cell.
std::string run_job(const std::string& input, const std::atomic<bool>& expired) {
  const auto job = restored<Job>(input);
  const std::vector<Row> rows = all_rows();
  const Row& row = named(rows, &Row::name, job.row);
  const std::vector<Column> columns = columns_of(row, job.registry());
  const Task task{&row, &named(row.cases, &SubCase::name, job.sub_case),
                  &named(columns, &Column::label, job.column)};
  StabilityCell cell = run_cell(task, job.seeds, job.limit_s, expired);
  for (double* figure : {&cell.gain, &cell.error})
    if (!std::isfinite(*figure)) *figure = std::nan("");
  experiments::Result result;
  if (cell.verdict == Verdict::kTooSlow) result.status = experiments::Status::kOutOfTime;
  result.cpu_s = cell.cpu_s;
  result.bytes = archived(cell);
  return archived(result);
}

/// Cells of the matrix, as tasks.
class Cells : public experiments::Experiment {
 public:
  Cells(const std::vector<Task>& tasks, const StabilityOptions& options)
      : tasks_(tasks), options_(options), cells_(tasks.size()) {}

  std::size_t size() const override { return tasks_.size(); }
  experiments::Task task(std::size_t i) override {
    const Task& one = tasks_[i];
    const std::string name = fmt::format("{}, {}, {}", one.row->name, one.sub_case->name, one.column->label);
    return {"stability", options_.registry ? "" : key_of(i), name, run_job, limit_of(i)};
  }
  std::string input(std::size_t i) override {
    const Task& one = tasks_[i];
    return archived(Job{one.row->name, one.sub_case->name, one.column->label, options_.seeds, limit_of(i),
                        options_.registry ? options_.registry : &integrate::stepper_registry});
  }
  void take(std::size_t i, const experiments::Result& result) override {
    if (!result.bytes.empty()) {
      cells_[i] = restored<StabilityCell>(result.bytes);
      return;
    }
    const bool slow = result.status == experiments::Status::kOutOfTime;
    StabilityCell& cell = cells_[i].emplace();
    cell.row = tasks_[i].row->name;
    cell.sub_case = tasks_[i].sub_case->name;
    cell.integrator = tasks_[i].column->label;
    cell.verdict = slow ? Verdict::kTooSlow : Verdict::kSilent;
    cell.reason = slow ? "cut off: " + result.reason : result.reason;
  }
  std::string progress_text(std::size_t i) override {
    return fmt::format("{}, {}", tasks_[i].row->name, tasks_[i].column->label);
  }
  std::string key() override {
    std::string keys;
    for (std::size_t i = 0; i < tasks_.size(); ++i) keys += key_of(i);
    return experiments::key_of({"stability", keys});
  }
  /// Returns the cells that ended.
  std::vector<StabilityCell> take_cells() {
    std::vector<StabilityCell> out;
    for (auto& cell : cells_)
      if (cell) out.push_back(std::move(*cell));
    return out;
  }

 private:
  std::string key_of(std::size_t i) const {
    const Task& one = tasks_[i];
    return experiments::key_of({"stability", one.row->name, one.sub_case->name, one.column->label,
                                fmt::format("{}", options_.seeds)});
  }
  double limit_of(std::size_t i) const {
    return (tasks_[i].row->slow ? kLongerInSlowRows : 1.0) * options_.limit_s;
  }

  const std::vector<Task>& tasks_;
  const StabilityOptions& options_;
  std::vector<std::optional<StabilityCell>> cells_;
};

}  // namespace

void StabilityCell::archive(Archive& a) {
  a("row", row);
  a("sub_case", sub_case);
  a("integrator", integrator);
  a("figure", figure);
  a("reason", reason);
  a("verdict", verdict);
  a("expected", expected);
  a("gain", gain);
  a("error", error);
  a("steps", steps);
  a("cpu_s", cpu_s);
}

std::vector<StabilityCell> run_cells(const std::vector<Task>& tasks, const StabilityOptions& options,
                                     experiments::EngineOutcome& outcome) {
  Cells cells(tasks, options);
  experiments::EngineOptions engine;
  engine.jobs = options.jobs;
  engine.stop = options.stop;
  engine.progress = options.progress;
  outcome = experiments::run(cells, options.place, engine);
  return cells.take_cells();
}

}  // namespace palpate::stability
