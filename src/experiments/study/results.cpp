#include "experiments/study/results.h"

#include <algorithm>
#include <filesystem>
#include <span>

#include "core/archive_bytes.h"
#include "experiments/study/figures.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/csv.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;
using experiments::Status;

constexpr const char* kPart = ".part";  ///< Suffix while the file is written.

std::size_t column_of(std::vector<std::string>& names, const std::string& name) {
  const auto at = std::find(names.begin(), names.end(), name);
  if (at != names.end()) return static_cast<std::size_t>(at - names.begin());
  names.push_back(name);
  return names.size() - 1;
}

void put(std::vector<std::string>& cells, std::size_t column, std::string text) {
  if (cells.size() <= column) cells.resize(column + 1);
  cells[column] = std::move(text);
}

void put_all(std::vector<std::string>& names, std::vector<std::string>& cells, const Columns& columns) {
  for (const auto& [name, value] : columns) put(cells, column_of(names, name), value);
}

/// Returns a TOML string without its quotes, and other values unchanged.
std::string unquoted(const std::string& value) {
  const bool quoted = value.size() > 1 && value.front() == '"' && value.back() == '"';
  return quoted ? value.substr(1, value.size() - 2) : value;
}

void add_settings(const Plan& plan, const Task& task, Results& out, Row& row) {
  const auto set = [&](const std::string& name, const std::string& text) {
    put(row.settings, column_of(out.settings, name), text);
  };
  set("scene", plan.scenes[task.scene].name);
  set("integrator", task.integrator);
  set("rtol", task.rtol);
  set("step_s", task.step_s);
  for (const auto& [name, value] : task.varied) set(name, unquoted(value));
}

/// Removes columns without any entry.
void drop_empty(std::vector<std::string>& names, std::vector<Row>& rows) {
  for (std::size_t c = names.size(); c-- > 0;) {
    if (std::any_of(rows.begin(), rows.end(), [&](const Row& row) { return !row.settings[c].empty(); }))
      continue;
    const auto at = static_cast<std::ptrdiff_t>(c);
    names.erase(names.begin() + at);
    for (Row& row : rows) row.settings.erase(row.settings.begin() + at);
  }
}

std::vector<store::CsvCell> cells_of(std::size_t index,
                                     std::initializer_list<std::span<const std::string>> lists) {
  std::vector<store::CsvCell> out = {static_cast<double>(index)};
  for (const auto& list : lists) out.insert(out.end(), list.begin(), list.end());
  return out;
}

std::vector<std::string> headers_of(std::initializer_list<std::vector<std::string>> lists) {
  std::vector<std::string> out = {"task"};
  for (const auto& list : lists) out.insert(out.end(), list.begin(), list.end());
  return out;
}

}  // namespace

std::size_t Results::count(const std::string& status) const {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [&](const Row& row) { return row.status == status; }));
}

Results merge(const Plan& plan, const experiments::ResultStore& store) {
  Results out;
  for (const Task& task : plan.tasks) {
    Row& row = out.rows.emplace_back();
    add_settings(plan, task, out, row);
    if (!task.refused.empty()) {
      row.status = to_string(Status::kRefused);
      row.reason = task.refused;
      continue;
    }
    auto kept = store.find(task.key);
    if (!kept) {
      row.status = to_string(Status::kMissing);
      out.missing.push_back(task.index);
      continue;
    }
    row.status = to_string(kept->status);
    // With the present limit: a task that exceeded a larger limit also exceeds a smaller one.
    row.reason = kept->status == Status::kOutOfTime
                     ? fmt::format("out of time: {:g} s of CPU", plan.spec.limit_s)
                     : kept->reason;
    if (!kept->bytes.empty()) {
      const auto run = restored<SceneRun>(kept->bytes);
      put_all(out.figures, row.figures, run.figures);
      put_all(out.times, row.times, run.times);
    }
    for (const auto& [name, value] : kept->machine.fields())
      put(row.times, column_of(out.times, name), *value);
  }
  for (Row& row : out.rows) {
    row.settings.resize(out.settings.size());
    row.figures.resize(out.figures.size());
    row.times.resize(out.times.size());
  }
  drop_empty(out.settings, out.rows);
  return out;
}

void write(const Plan& plan, const Results& results, const std::string& folder) {
  const fs::path dir(folder);
  const std::string table_path = (dir / "study.csv").string(),
                    times_path = (dir / "study-times.csv").string();
  store::CsvWriter table(table_path + kPart,
                         headers_of({results.settings, {"status", "reason"}, results.figures}));
  store::CsvWriter times(times_path + kPart, headers_of({{"status"}, results.times}));
  for (std::size_t i = 0; i < results.rows.size(); ++i) {
    const Row& row = results.rows[i];
    table.row(cells_of(i, {row.settings, {&row.status, 1}, {&row.reason, 1}, row.figures}));
    times.row(cells_of(i, {{&row.status, 1}, row.times}));
  }
  table.close();
  times.close();
  fs::rename(table_path + kPart, table_path);
  fs::rename(times_path + kPart, times_path);
  store::write_atomically((dir / "study.toml").string(), plan.spec.text);
}

}  // namespace palpate::study
