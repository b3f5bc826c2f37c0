#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "palpate/compare/compare.h"
#include "palpate/core/error.h"
#include "palpate/store/atomic_file.h"
#include "palpate/store/csv.h"
#include "palpate/store/study_columns.h"

namespace palpate::compare {
namespace {

namespace fs = std::filesystem;
using store::CsvCell;
using Row = std::vector<CsvCell>;

const std::vector<std::string> kExchangeColumns = {
    "scene", "exchange_period_s", "position_error_rel_l2", "force_error_rms_n", "torque_error_rms_n_m",
    "cpu_s"};

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
CsvCell yes_no(bool yes) { return std::string(yes ? "yes" : "no"); }

Row row_of(const std::string& scene, const ComparePoint& p) {
  const TrajectoryError& e = p.error;
  const loop::RunResult& r = p.result;
  const dynamics::StepperCounters& c = r.counters;
  const bool timed = !p.cpu_s.empty();
  const auto time = [&](double s) { return CsvCell(timed ? s : std::numeric_limits<double>::quiet_NaN()); };
  return {scene,
          p.label,
          p.integrator,
          p.family,
          number(p.order),
          p.stability,
          yes_no(p.multistep),
          p.setting_name,
          p.setting,
          e.position_rel_l2,
          e.position_max_m,
          e.force_rms_n,
          e.force_max_n,
          e.torque_rms_n_m,
          e.torque_max_n_m,
          e.energy_j,
          time(p.cpu_median_s),
          time(p.cpu_min_s),
          time(p.cpu_max_s),
          number(static_cast<long>(p.cpu_s.size())),
          number(c.force_evaluations),
          number(c.tangent_evaluations),
          number(c.solver.factorisations),
          number(c.solver.solves),
          number(c.newton_iterations),
          number(r.contact_queries),
          number(c.steps),
          number(c.rejected),
          number(c.reinits),
          std::string(to_string(p.status)),
          p.reason,
          yes_no(p.unresolved),
          yes_no(p.force_unresolved),
          yes_no(p.torque_unresolved)};
}

Row restart_row(const std::string& scene, const ComparePoint& p) {
  const dynamics::StepperCounters& c = p.result.counters;
  return {scene,
          p.label,
          p.integrator,
          yes_no(p.multistep),
          p.setting,
          p.result.time,
          number(c.reinits),
          number(c.steps),
          number(c.force_evaluations),
          number(c.solver.factorisations),
          p.result.cpu_s,
          std::string(to_string(p.status)),
          p.reason};
}

Row exchange_row(const std::string& scene, const ExchangePoint& p) {
  return {scene,  p.exchange_period_s, p.error.position_rel_l2, p.error.force_rms_n, p.error.torque_rms_n_m,
          p.cpu_s};
}

Row method_row(const std::string& scene, const MethodPoint& p) {
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

/// One table over all scenes; no file where it would be empty (and none stays from before).
template <class Point, class ToRow>
void write_table(const Comparison& comparison, const fs::path& path, const std::vector<std::string>& columns,
                 std::vector<Point> SceneComparison::*points, ToRow to_row) {
  std::error_code none;
  fs::remove(path, none);
  std::optional<store::CsvWriter> csv;
  for (const SceneComparison& scene : comparison.scenes)
    for (const Point& point : scene.*points) {
      if constexpr (std::is_same_v<Point, ComparePoint>)
        if (point.status == PointStatus::kMissing) continue;  // stopped before it
      if (!csv) csv.emplace(path.string(), columns);
      csv->row(to_row(scene.scene, point));
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
          {"cpu_s", scene.reference.cpu_s},
          {"notes", notes}};
}

}  // namespace

void write(const Comparison& comparison, const std::string& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) fail("{}: the results' folder cannot be made: {}", folder, failed.message());
  const fs::path base(folder);
  write_table(comparison, base / "compare.csv", store::compare_columns(), &SceneComparison::points, row_of);
  write_table(comparison, base / "restarts.csv", store::restart_columns(), &SceneComparison::restarts,
              restart_row);
  write_table(comparison, base / "exchange.csv", kExchangeColumns, &SceneComparison::exchange, exchange_row);
  write_table(comparison, base / "methods.csv", kMethodColumns, &SceneComparison::methods, method_row);
  nlohmann::ordered_json references = {{"rules", comparison.rules},
                                       {"scenes", nlohmann::ordered_json::array()}};
  for (const SceneComparison& scene : comparison.scenes) references["scenes"].push_back(reference_of(scene));
  store::write_atomically((base / "reference.json").string(), references.dump(2) + "\n");
}

}  // namespace palpate::compare
