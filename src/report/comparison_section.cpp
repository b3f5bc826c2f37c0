#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"
#include "sections.h"

namespace palpate::report {
namespace {

bool is_yes(const std::string& cell) { return cell == "true" || cell == "1" || cell == "yes"; }

/// An error that a comparison can show: its column, what it is called, and the reference's own.
struct Quantity {
  std::string column, label;
  double reference;
};

/// Errors that are nowhere larger than this are rounding, and get no plot: a scene without torque has no error of it.
constexpr double kRounding = 1e-15;

std::vector<Quantity> quantities_of(const Table& table, const ReferenceError& reference) {
  const std::vector<Quantity> all = {{"position_error_rel_l2", "position error, relative L2 [-]", reference.position_error_rel_l2},
                                     {"force_error_rms_n", "force error, RMS [N]", reference.force_error_rms_n},
                                     {"torque_error_rms_n_m", "torque error, RMS [N m]", reference.torque_error_rms_n_m}};
  std::vector<Quantity> present;
  for (const Quantity& q : all) {
    if (!table.has(q.column)) continue;
    const std::vector<double> values = table.numbers(q.column);
    if (std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v) && v > kRounding; })) present.push_back(q);
  }
  return present;
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string point_text(const Table& compare, std::size_t row) {
  return setting_text(compare.rows[row][compare.column("setting_name")], to_number(compare.rows[row][compare.column("setting")]));
}

/// The cell of a column as a short number; integers stay as they are; "-" where the column is missing or empty.
std::string cell_text(const Table& table, std::size_t row, const std::string& column) {
  if (!table.has(column)) return "-";
  const std::string& cell = table.rows[row][table.column(column)];
  const double value = to_number(cell);
  return std::isnan(value) ? "-" : value == std::floor(value) && std::abs(value) < 1e15 ? fmt::format("{:.0f}", value) : short_number(value);
}

void add_points_table(Page& page, const Table& compare) {
  std::vector<std::vector<std::string>> rows;
  std::vector<RowMark> marks;
  const std::size_t integrator = compare.column("integrator"), status = compare.column("status"), below = compare.column("below_reference");
  for (std::size_t r = 0; r < compare.rows.size(); ++r) {
    const auto& row = compare.rows[r];
    const bool ok = row[status] == "ok", under = is_yes(row[below]);
    rows.push_back({row[integrator], point_text(compare, r), cell_text(compare, r, "position_error_rel_l2"), cell_text(compare, r, "force_error_rms_n"),
                    cell_text(compare, r, "torque_error_rms_n_m"), cell_text(compare, r, "energy_error_j"), cell_text(compare, r, "cpu_s_median"),
                    cell_text(compare, r, "cpu_s_min") + " – " + cell_text(compare, r, "cpu_s_max"),
                    !ok ? row[status] : under ? "below reference" : "ok"});
    marks.push_back(!ok ? RowMark::kBad : under ? RowMark::kFaint : RowMark::kNone);
  }
  page.add_table({"integrator", "setting", "position error, rel. L2", "force error, RMS [N]", "torque error, RMS [N m]", "energy error [J]",
                  "CPU [s], median", "CPU [s], least – most", "status"},
                 rows, "“Below reference”: the error is smaller than the reference's own, so it says no more than that.", marks);
}

/// One line a point, under the columns of compare.csv that are named.
void add_columns_table(Page& page, const Table& compare, const std::vector<std::pair<std::string, std::string>>& columns, const std::string& caption) {
  std::vector<std::string> headers = {"integrator", "setting"};
  for (const auto& [column, header] : columns) headers.push_back(header);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t r = 0; r < compare.rows.size(); ++r) {
    rows.push_back({compare.rows[r][compare.column("integrator")], point_text(compare, r)});
    for (const auto& [column, header] : columns) rows.back().push_back(cell_text(compare, r, column));
  }
  page.add_table(headers, rows, caption);
}

void add_counts_and_maxima(Page& page, const Table& compare) {
  add_columns_table(page, compare,
                    {{"steps", "steps"}, {"force_evaluations", "force evaluations"}, {"tangent_evaluations", "tangent evaluations"},
                     {"factorisations", "factorisations"}, {"linear_solves", "linear solves"}, {"contact_queries", "contact queries"}},
                    "Counts, which no noise of the machine touches.");
  add_columns_table(page, compare,
                    {{"position_error_max_m", "position error [m]"}, {"force_error_max_n", "force error [N]"}, {"torque_error_max_n_m", "torque error [N m]"}},
                    "The largest errors over all nodes and times.");
}

std::string order_text(const FittedOrder& fitted) {
  if (!std::isfinite(fitted.order)) return "-";
  return fmt::format("{:.2f} ({} points)", fitted.order, fitted.points);
}

void add_orders_table(Page& page, const Table& compare, const std::vector<Quantity>& quantities) {
  std::vector<std::string> headers = {"integrator", "against"};
  std::vector<std::vector<std::string>> rows;
  for (const Quantity& q : quantities) {
    headers.push_back(q.label);
    const std::vector<FittedOrder> orders = fitted_orders(compare, q.column);
    if (rows.empty())
      for (const FittedOrder& f : orders) rows.push_back({f.integrator, f.setting_name == "step_s" ? "step" : f.setting_name});
    for (std::size_t i = 0; i < orders.size(); ++i) rows[i].push_back(order_text(orders[i]));
  }
  page.add_heading("Fitted order", 3);
  page.add_table(headers, rows, "Least-squares slope of log error against log step (or tolerance: 1 means that the error follows the tolerance). Points below the reference are left out.");
}

void add_cheapest_table(Page& page, const Table& compare) {
  std::vector<std::vector<std::string>> rows;
  for (const Cheapest& best : cheapest(compare, "position_error_rel_l2", {1e-2, 1e-3, 1e-4})) {
    if (best.found) rows.push_back({fmt::format("{:g}", best.target), best.integrator, setting_text(best.setting_name, best.setting), short_number(best.error), short_number(best.cpu_s)});
    else rows.push_back({fmt::format("{:g}", best.target), "none reaches it", "-", "-", "-"});
  }
  page.add_heading("Cheapest for a wanted error", 3);
  page.add_table({"position error at most", "integrator", "setting", "its error", "its CPU [s]"}, rows);
}

}  // namespace

void add_comparison(Page& page, const Table& compare, const ReferenceError& reference) {
  page.add_heading("Error against run time");
  if (!reference.description.empty()) page.add_paragraph("Reference: " + reference.description);
  const std::vector<Quantity> quantities = quantities_of(compare, reference);
  for (const Quantity& q : quantities)
    add_plot(page, work_precision_plot(compare, q.column, q.label, q.reference),
             capitalised(q.label) + " against CPU time; down and to the left is better. Each point carries its relative tolerance or its step; rings lie below the reference's own error" +
                 (std::isfinite(q.reference) ? fmt::format(" of {}.", short_number(q.reference)) : "."));
  if (const std::vector<double> torque = compare.has("torque_error_max_n_m") ? compare.numbers("torque_error_max_n_m") : std::vector<double>{};
      !torque.empty() && *std::max_element(torque.begin(), torque.end()) <= kRounding)
    page.add_paragraph("No torque: its largest error is rounding, for this scene makes none.");
  if (quantities.empty()) page.add_paragraph("No point of the comparison has a measured error.");
  add_cheapest_table(page, compare);
  if (!quantities.empty()) add_orders_table(page, compare, quantities);
  page.add_heading("All points", 3);
  add_points_table(page, compare);
  add_counts_and_maxima(page, compare);
}

void add_exchange(Page& page, const Table& exchange) {
  page.add_heading("Error of the exchange period");
  page.add_paragraph("How often tool and bodies exchange forces belongs to the scene, not to the integrator. This is what the choice costs by itself: the same tight integrator at every period, against the shortest.");
  for (const Quantity& q : quantities_of(exchange, {})) add_plot(page, exchange_plot(exchange, q.column, q.label), capitalised(q.label) + " against the exchange period.");
  std::vector<std::vector<std::string>> rows;
  for (std::size_t r = 0; r < exchange.rows.size(); ++r) {
    rows.emplace_back();
    for (const std::string& column : exchange_columns()) rows.back().push_back(cell_text(exchange, r, column));
  }
  page.add_table({"exchange period [s]", "position error, rel. L2", "force error, RMS [N]", "torque error, RMS [N m]", "CPU [s]"}, rows);
}

void add_methods(Page& page, const Table& methods) {
  page.add_heading("Ways to find the contact");
  page.add_paragraph("The same touch at the same integrator settings, its contact found in different ways; each against the first. The difference holds what each makes of the "
                     "tool (an exact shape or facets) and of the overlap (one sample a vertex, or one a pixel).");
  const std::vector<std::string> columns = {"method", "position_difference_rel_l2", "position_difference_max_m", "force_difference_rms_n", "force_difference_max_n",
                                            "peak_force_n", "most_samples", "query_s", "cpu_s"};
  std::vector<std::vector<std::string>> rows;
  for (std::size_t r = 0; r < methods.rows.size(); ++r) {
    rows.emplace_back();
    for (const std::string& column : columns) rows.back().push_back(cell_text(methods, r, column));
  }
  page.add_table({"method", "position difference, rel. L2", "largest [m]", "force difference, RMS [N]", "largest [N]", "peak force [N]", "samples at most",
                  "queries [s]", "CPU [s]"}, rows);
}

}  // namespace palpate::report
