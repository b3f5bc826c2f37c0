#include <algorithm>
#include <filesystem>
#include <limits>

#include "experiments/compare/cells.h"
#include "experiments/compare/haptic.h"
#include "experiments/compare/monolithic.h"
#include "palpate/core/error.h"
#include "store/csv.h"

namespace palpate::compare {
namespace {

namespace fs = std::filesystem;
using store::CsvCell;

/// Returns names and cells of one point, in the order of the columns.
std::vector<std::pair<std::string, CsvCell>> cells_of(const HapticComparison& c, const HapticPoint& p) {
  const bool ran = p.status == Status::kOk;
  const auto time = [ran](double s) { return CsvCell(ran ? s : kEmpty); };
  const auto [least, greatest] = std::minmax_element(p.cpu_s.begin(), p.cpu_s.end());
  std::vector<std::pair<std::string, CsvCell>> out = {
      {"scene", c.scene},
      {"variable", p.variable},
      {"value", p.value},
      {"setting", p.setting},
      {"own", yes_no(p.own)},
      {"force_error_rms_n", p.error.force_rms_n},
      {"force_error_max_n", p.error.force_max_n},
      {"force_error_rms_of_peak", share_of_peak(p.error.force_rms_n, c.peak_force_n)},
      {"force_error_max_of_peak", share_of_peak(p.error.force_max_n, c.peak_force_n)},
      {"torque_error_rms_n_m", p.error.torque_rms_n_m},
      {"torque_error_max_n_m", p.error.torque_max_n_m},
      {"torque_error_rms_of_peak", share_of_peak(p.error.torque_rms_n_m, c.peak_torque_n_m)},
      {"torque_error_max_of_peak", share_of_peak(p.error.torque_max_n_m, c.peak_torque_n_m)},
      {"force_unresolved", yes_no(p.force_unresolved)},
      {"torque_unresolved", yes_no(p.torque_unresolved)},
      {"cpu_s_median", time(p.cpu_median_s)},
      {"cpu_s_min", time(p.cpu_s.empty() ? kEmpty : *least)},
      {"cpu_s_max", time(p.cpu_s.empty() ? kEmpty : *greatest)},
      {"repeats", static_cast<double>(p.cpu_s.size())},
      {"bodies_s", time(p.bodies_s())},
      {"status", std::string(to_string(p.status))},
      {"reason", p.reason}};
  loop::visit_counters(
      [&](const char* name, const auto& value) { out.emplace_back(name, time(static_cast<double>(value))); },
      p.result);
  return out;
}

}  // namespace

void write(const HapticComparison& c, const std::string& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) fail("{}: the results' folder cannot be created: {}", folder, failed.message());
  std::vector<std::string> columns;
  for (const auto& [name, cell] : cells_of(c, {})) columns.push_back(name);
  store::CsvWriter csv((fs::path(folder) / "haptic.csv").string(), columns);
  for (const HapticPoint& p : c.points) {
    if (p.status == Status::kMissing) continue;  // Stopped before it.
    std::vector<CsvCell> row;
    for (auto& [name, cell] : cells_of(c, p)) row.push_back(std::move(cell));
    csv.row(row);
  }
  csv.close();
}

}  // namespace palpate::compare
