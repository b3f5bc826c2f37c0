#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "palpate/core/error.h"
#include "palpate/store/atomic_file.h"
#include "palpate/store/csv.h"
#include "palpate/study/compare.h"

namespace palpate::study {
namespace {

using store::CsvCell;

const std::vector<std::string> kPointColumns = {
    "scene", "integrator", "setting_name", "setting", "position_error_rel_l2", "position_error_max_m", "force_error_rms_n", "force_error_max_n",
    "torque_error_rms_n_m", "torque_error_max_n_m", "energy_error_j", "cpu_s_median", "cpu_s_min", "cpu_s_max", "force_evaluations",
    "tangent_evaluations", "factorisations", "linear_solves", "contact_queries", "steps", "status", "below_reference",
    "force_below_reference", "torque_below_reference"};

const std::vector<std::string> kExchangeColumns = {"exchange_period_s", "position_error_rel_l2", "force_error_rms_n", "torque_error_rms_n_m", "cpu_s"};

const std::vector<std::string> kMethodColumns = {"method",          "position_difference_rel_l2", "position_difference_max_m", "force_difference_rms_n",
                                                 "force_difference_max_n", "peak_force_n",           "most_samples",              "query_s",
                                                 "cpu_s"};

std::vector<CsvCell> row_of(const std::string& scene, const ComparePoint& p) {
  const auto count = [](long n) { return CsvCell(static_cast<double>(n)); };
  const auto yes_no = [](bool yes) { return std::string(yes ? "yes" : "no"); };
  const TrajectoryError& e = p.error;
  const dynamics::StepperCounters& c = p.result.counters;
  const std::string status = p.result.status.ok() ? "ok" : fmt::format("{}: {}", dynamics::to_string(p.result.status.status), p.result.status.message);
  return {scene, p.integrator, p.setting_name, p.setting, e.position_rel_l2, e.position_max_m, e.force_rms_n, e.force_max_n, e.torque_rms_n_m,
          e.torque_max_n_m, e.energy_j, p.cpu_median_s, p.cpu_min_s, p.cpu_max_s, count(c.force_evaluations), count(c.tangent_evaluations),
          count(c.solver.factorisations), count(c.solver.solves), count(p.result.contact_queries), count(c.steps), status,
          yes_no(p.below_reference), yes_no(p.force_below_reference), yes_no(p.torque_below_reference)};
}

}  // namespace

void write(const Comparison& comparison, const std::string& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) fail("{}: the results' folder cannot be made: {}", folder, failed.message());
  const std::filesystem::path base(folder);
  store::CsvWriter points((base / "compare.csv").string(), kPointColumns);
  for (const ComparePoint& p : comparison.points)
    if (!p.cpu_s.empty()) points.row(row_of(comparison.scene, p));
  points.close();
  if (!comparison.exchange.empty()) {
    store::CsvWriter exchange((base / "exchange.csv").string(), kExchangeColumns);
    for (const ExchangePoint& p : comparison.exchange)
      exchange.row(std::vector<CsvCell>{p.exchange_period_s, p.error.position_rel_l2, p.error.force_rms_n, p.error.torque_rms_n_m, p.cpu_s});
    exchange.close();
  }
  if (!comparison.methods.empty()) {
    store::CsvWriter methods((base / "methods.csv").string(), kMethodColumns);
    for (const MethodPoint& p : comparison.methods)
      methods.row(std::vector<CsvCell>{p.method, p.difference.position_rel_l2, p.difference.position_max_m, p.difference.force_rms_n, p.difference.force_max_n,
                                       p.peak_force_n, static_cast<double>(p.most_samples), p.query_s, p.cpu_s});
    methods.close();
  }
  const TrajectoryError& own = comparison.reference.own_error;
  const nlohmann::json reference = {{"position_error_rel_l2", own.position_rel_l2},
                                    {"force_error_rms_n", own.force_rms_n},
                                    {"torque_error_rms_n_m", own.torque_rms_n_m},
                                    {"cpu_s", comparison.reference.cpu_s},
                                    {"description", comparison.reference.description}};
  store::write_atomically((base / "reference.json").string(), reference.dump(2) + "\n");
}

}  // namespace palpate::study
