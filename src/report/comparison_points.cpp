#include <algorithm>
#include <cmath>

#include "comparison_cells.h"
#include "comparison_tables.h"
#include "palpate/core/error.h"
#include "store/study_columns.h"

namespace palpate::report {
namespace {

std::string point_text(const Table& compare, std::size_t row) {
  return setting_text(compare.cell(row, "setting_name"), to_number(compare.cell(row, "setting")));
}

/// Returns the ratio of achieved to requested error of a point controlled by a tolerance.
std::string achieved_text(const Table& compare, std::size_t row) {
  if (compare.cell(row, "setting_name") != "rtol") return "-";
  const double error = to_number(compare.cell(row, "position_error_rel_l2")),
               requested = to_number(compare.cell(row, "setting"));
  return std::isfinite(error) ? short_number(error / requested) : "-";
}

/// Adds a table with one line per point and the given columns of compare.csv.
void add_columns_table(Page& page, const Table& compare,
                       const std::vector<std::pair<std::string, std::string>>& columns,
                       const std::string& caption) {
  std::vector<std::string> headers = {"integrator", "setting"};
  for (const auto& [column, header] : columns) headers.push_back(header);
  Rows rows;
  for (std::size_t r = 0; r < compare.rows.size(); ++r) {
    rows.push_back({compare.cell(r, "label"), point_text(compare, r)});
    for (const auto& [column, header] : columns) rows.back().push_back(cell_text(compare, r, column));
  }
  page.add_table(headers, rows, caption);
}

/// Returns the counts after the known columns of compare.csv that are nonzero at any point.
std::vector<std::pair<std::string, std::string>> further_counts(const Table& compare) {
  const std::vector<std::string>& known = store::compare_columns();
  std::vector<std::pair<std::string, std::string>> out;
  for (const std::string& column : compare.headers) {
    if (column.ends_with("_s") || std::find(known.begin(), known.end(), column) != known.end()) continue;
    if (!compare.exceeds(column, 0.0)) continue;
    std::string words = column;
    std::replace(words.begin(), words.end(), '_', ' ');
    out.emplace_back(column, words);
  }
  return out;
}

}  // namespace

void add_points_table(Page& page, const Table& compare) {
  Rows rows;
  std::vector<RowMark> marks;
  const std::size_t label = compare.column("label"), status = compare.column("status"),
                    reason = compare.column("reason"), below = compare.column("unresolved");
  for (std::size_t r = 0; r < compare.rows.size(); ++r) {
    const auto& row = compare.rows[r];
    const bool ok = row[status] == "ok", under = is_yes(row[below]);
    rows.push_back({row[label], point_text(compare, r), cell_text(compare, r, "error_test_rtol"),
                    achieved_text(compare, r), cell_text(compare, r, "position_error_rel_l2"),
                    cell_text(compare, r, "force_error_rms_n"), cell_text(compare, r, "torque_error_rms_n_m"),
                    cell_text(compare, r, "energy_error_j"), cell_text(compare, r, "cpu_s_median"),
                    cell_text(compare, r, "cpu_s_min") + " – " + cell_text(compare, r, "cpu_s_max"),
                    cell_text(compare, r, "repeats"), cell_text(compare, r, "linear_solver"),
                    cell_text(compare, r, "against"),
                    !ok     ? (row[reason].empty() ? row[status] : row[reason])
                    : under ? "below reference"
                            : "ok"});
    marks.push_back(!ok ? RowMark::kBad : under ? RowMark::kFaint : RowMark::kNone);
  }
  page.add_table({"integrator", "setting", "error test", "position error / rtol", "position error, rel. L2",
                  "force error, RMS [N]", "torque error, RMS [N m]", "energy error [J]", "CPU [s], median",
                  "CPU [s], least – most", "runs", "linear solver", "reference", "status"},
                 rows,
                 "“Below reference”: the error is within ten times the reference error and is not resolved.",
                 marks);
}

void add_counts_and_maxima(Page& page, const Table& compare) {
  std::vector<std::pair<std::string, std::string>> counts = {{"steps", "steps"},
                                                             {"force_evaluations", "force evaluations"},
                                                             {"tangent_evaluations", "tangent evaluations"},
                                                             {"factorisations", "factorisations"},
                                                             {"linear_solves", "linear solves"},
                                                             {"newton_iterations", "Newton iterations"},
                                                             {"rejected_steps", "rejected steps"},
                                                             {"reinitialisations", "restarts"},
                                                             {"contact_queries", "contact queries"}};
  for (auto& further : further_counts(compare)) counts.push_back(std::move(further));
  add_columns_table(page, compare, counts, "Counts, independent of timing noise.");
  add_columns_table(page, compare,
                    {{"cpu_s_median", "total without set-up and recording, median"},
                     {"method_s", "method"},
                     {"contact_query_s", "contact queries"},
                     {"linearise_s", "linearisation for the tool"},
                     {"tool_ticks_s", "tool ticks"},
                     {"setup_s", "set-up"},
                     {"record_s", "recording, including the energy of the bodies"}},
                    "Distribution of the run time in the first repeat [s].");
  add_columns_table(page, compare,
                    {{"position_error_max_m", "position error [m]"},
                     {"force_error_max_n", "force error [N]"},
                     {"torque_error_max_n_m", "torque error [N m]"}},
                    "Largest errors over all nodes and times.");
}

}  // namespace palpate::report
