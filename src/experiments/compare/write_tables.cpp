#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "experiments/compare/cells.h"
#include "palpate/core/error.h"
#include "palpate/experiments/compare.h"
#include "store/atomic_file.h"
#include "store/csv.h"
#include "store/study_columns.h"

namespace palpate::compare {
namespace {

namespace fs = std::filesystem;
using store::CsvCell;
using Row = std::vector<CsvCell>;

const std::vector<std::string> kExchangeColumns = {
    "scene", "exchange_period_s", "position_error_rel_l2", "force_error_rms_n", "torque_error_rms_n_m",
    "cpu_s", "unresolved",        "force_unresolved",      "torque_unresolved"};

const std::vector<std::string> kMethodColumns = {"scene",
                                                 "method",
                                                 "position_difference_rel_l2",
                                                 "position_difference_max_m",
                                                 "force_difference_rms_n",
                                                 "force_difference_max_n",
                                                 "peak_force_n",
                                                 "most_samples",
                                                 "query_s",
                                                 "cpu_s"};

CsvCell number(long n) { return static_cast<double>(n); }

/// Returns the columns that reports use, followed by all other numbers of a run.
std::vector<std::string> with_every_number(std::vector<std::string> columns) {
  const loop::RunResult none;
  loop::visit_counters(
      [&columns](const char* name, const auto&) {
        if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.emplace_back(name);
      },
      none);
  return columns;
}

/// Returns a run's numbers and the given cells, in the order of the columns.
Row in_order(const std::vector<std::string>& columns, const loop::RunResult& result,
             std::map<std::string, CsvCell> cells) {
  loop::visit_counters(
      [&cells](const char* name, const auto& value) { cells.emplace(name, static_cast<double>(value)); },
      result);
  Row row;
  for (const std::string& column : columns) {
    const auto cell = cells.find(column);
    PALPATE_CHECK(cell != cells.end(), "no cell for the column {}", column);
    row.push_back(cell->second);
  }
  return row;
}

Row row_of(const std::vector<std::string>& columns, const std::string& scene, const ComparePoint& p) {
  const TrajectoryError& e = p.error;
  const bool timed = !p.cpu_s.empty();
  const auto time = [&](double s) { return CsvCell(timed ? s : std::numeric_limits<double>::quiet_NaN()); };
  return in_order(columns, p.result,
                  {{"scene", scene},
                   {"label", p.label},
                   {"integrator", p.integrator},
                   {"family", p.family},
                   {"order", number(p.order)},
                   {"stability", p.stability},
                   {"multistep", yes_no(p.multistep)},
                   {"setting_name", p.setting_name},
                   {"setting", p.setting},
                   {"error_test_rtol", p.error_test_rtol},
                   {"coarsest", yes_no(p.coarsest)},
                   {"linear_solver", p.linear_solver},
                   {"against", p.against},
                   {"method_s", time(p.method_s())},
                   {"setup_s", time(p.setup_s)},
                   {"record_s", time(p.record_s)},
                   {"position_error_rel_l2", e.position_rel_l2},
                   {"position_error_max_m", e.position_max_m},
                   {"force_error_rms_n", e.force_rms_n},
                   {"force_error_max_n", e.force_max_n},
                   {"torque_error_rms_n_m", e.torque_rms_n_m},
                   {"torque_error_max_n_m", e.torque_max_n_m},
                   {"energy_error_j", e.energy_j},
                   {"cpu_s_median", time(p.cpu_median_s)},
                   {"cpu_s_min", time(p.cpu_min_s)},
                   {"cpu_s_max", time(p.cpu_max_s)},
                   {"repeats", number(static_cast<long>(p.cpu_s.size()))},
                   {"status", std::string(to_string(p.status))},
                   {"reason", p.reason},
                   {"unresolved", yes_no(p.unresolved)},
                   {"force_unresolved", yes_no(p.force_unresolved)},
                   {"torque_unresolved", yes_no(p.torque_unresolved)}});
}

Row restart_row(const std::vector<std::string>& columns, const std::string& scene, const ComparePoint& p) {
  return in_order(columns, p.result,
                  {{"scene", scene},
                   {"label", p.label},
                   {"integrator", p.integrator},
                   {"multistep", yes_no(p.multistep)},
                   {"contact_refresh_s", p.setting},
                   {"cpu_s", p.result.cpu_s},
                   {"status", std::string(to_string(p.status))},
                   {"reason", p.reason}});
}

Row exchange_row(const std::vector<std::string>&, const std::string& scene, const ExchangePoint& p) {
  return {scene,
          p.exchange_period_s,
          p.error.position_rel_l2,
          p.error.force_rms_n,
          p.error.torque_rms_n_m,
          p.cpu_s,
          yes_no(p.unresolved),
          yes_no(p.force_unresolved),
          yes_no(p.torque_unresolved)};
}

Row method_row(const std::vector<std::string>&, const std::string& scene, const MethodPoint& p) {
  return {scene,
          p.method,
          p.difference.position_rel_l2,
          p.difference.position_max_m,
          p.difference.force_rms_n,
          p.difference.force_max_n,
          p.peak_force_n,
          number(p.most_samples),
          p.query_s,
          p.cpu_s};
}

/// Writes one table over all scenes; an empty table gives no file, and removes an old one.
template <class Point>
void write_table(const Comparison& comparison, const fs::path& path, const std::vector<std::string>& columns,
                 const std::vector<Point>& (*points)(const SceneComparison&),
                 Row (*to_row)(const std::vector<std::string>&, const std::string&, const Point&)) {
  std::error_code none;
  fs::remove(path, none);
  std::optional<store::CsvWriter> csv;
  for (const SceneComparison& scene : comparison.scenes)
    for (const Point& point : points(scene)) {
      if constexpr (std::is_same_v<Point, ComparePoint>)
        if (point.status == Status::kMissing) continue;  // Stopped before it.
      if (!csv) csv.emplace(path.string(), columns);
      csv->row(to_row(columns, scene.scene, point));
    }
  if (csv) csv->close();
}

nlohmann::ordered_json reference_of(const SceneComparison& scene) {
  const TrajectoryError& own = scene.reference.own_error;
  nlohmann::ordered_json notes = nlohmann::ordered_json::array();
  for (const MissingChart& chart : scene.missing_charts) notes.push_back(chart.text());
  return {{"scene", scene.scene},
          {"path", scene.path},
          {"description", scene.reference.description},
          {"trouble", scene.reference.trouble},
          {"position_error_rel_l2", own.position_rel_l2},
          {"force_error_rms_n", own.force_rms_n},
          {"torque_error_rms_n_m", own.torque_rms_n_m},
          {"peak_force_n", scene.reference.peak_force_n},
          {"peak_torque_n_m", scene.reference.peak_torque_n_m},
          {"cpu_s", scene.reference.cpu_s},
          {"exchange",
           {{"made_by", scene.exchange.made_by},
            {"checked_by", scene.exchange.checked_by},
            {"position_error_rel_l2", scene.exchange.own_error.position_rel_l2},
            {"force_error_rms_n", scene.exchange.own_error.force_rms_n},
            {"torque_error_rms_n_m", scene.exchange.own_error.torque_rms_n_m}}},
          {"notes", notes}};
}

}  // namespace

void write(const Comparison& comparison, const std::string& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) fail("{}: the results' folder cannot be created: {}", folder, failed.message());
  const fs::path base(folder);
  const std::vector<std::string> columns = with_every_number(store::compare_columns());
  using Scene = const SceneComparison&;
  write_table<ComparePoint>(
      comparison, base / "compare.csv", columns, [](Scene s) -> auto& { return s.points; }, row_of);
  write_table<ComparePoint>(
      comparison, base / "trials.csv", columns, [](Scene s) -> auto& { return s.trials; }, row_of);
  write_table<ComparePoint>(
      comparison, base / "restarts.csv", with_every_number(store::restart_columns()),
      [](Scene s) -> auto& { return s.restarts; }, restart_row);
  write_table<ExchangePoint>(
      comparison, base / "exchange.csv", kExchangeColumns, [](Scene s) -> auto& { return s.exchange.points; },
      exchange_row);
  write_table<MethodPoint>(
      comparison, base / "methods.csv", kMethodColumns, [](Scene s) -> auto& { return s.methods; },
      method_row);
  nlohmann::ordered_json references = {{"rules", comparison.rules},
                                       {"scenes", nlohmann::ordered_json::array()}};
  for (const SceneComparison& scene : comparison.scenes) references["scenes"].push_back(reference_of(scene));
  store::write_atomically((base / "reference.json").string(), references.dump(2) + "\n");
}

}  // namespace palpate::compare
