#include <algorithm>
#include <cmath>

#include "comparison_cells.h"
#include "log_line.h"
#include "palpate/core/error.h"
#include "sections.h"

/// Section for the force on the hand against the monolithic solution of tool and bodies: haptic.csv of
/// `palpate compare --haptic`.
namespace palpate::report {
namespace {

/// Quantity on the hand, with its names in haptic.csv and summary.json.
struct Felt {
  std::string name;                        ///< "force"
  std::string error, of_peak, unresolved;  ///< Columns
  double peak, own_error;                  ///< Peak and error of the reference
};

Felt felt(const std::string& name, const std::string& unit, const Json& reference) {
  return {name,
          fmt::format("{}_error_rms_{}", name, unit),
          fmt::format("{}_error_rms_of_peak", name),
          fmt::format("{}_unresolved", name),
          number_at(reference, fmt::format("peak_{}_{}", name, unit).c_str()),
          number_at(reference, fmt::format("{}_error_rms_{}", name, unit).c_str())};
}

/// Returns the points of one variable, in percent of the peak of the reference.
Series series_of(const Table& table, const Felt& q, const std::string& variable, const std::string& x_column,
                 bool labelled) {
  const Table own = rows_where(table, "variable", variable);
  Series out{.name = variable, .x = own.numbers(x_column), .y = own.numbers(q.of_peak)};
  out.mark =
      own.rows.empty() || std::isnan(own.numbers("setting").front()) ? Mark::kPoints : Mark::kLinePoints;
  for (double& y : out.y) y *= 100.0;
  for (const auto& row : own.rows) {
    out.hollow.push_back(is_yes(row[own.column(q.unresolved)]));
    if (labelled) out.labels.push_back(row[own.column("value")]);
  }
  return out;
}

/// Adds a dashed line with the slope of a fitted order through the points of the fit.
void add_fit(Plot& plot, const Series& points, double order) {
  if (!std::isfinite(order)) return;
  double sum = 0.0, n = 0.0, least = HUGE_VAL, greatest = 0.0;
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    if (points.hollow[i] || !(points.y[i] > 0.0 && points.y[i] <= 10.0)) continue;
    sum += std::log(points.y[i]) - order * std::log(points.x[i]);
    n += 1.0;
    least = std::min(least, points.x[i]);
    greatest = std::max(greatest, points.x[i]);
  }
  if (n < 2.0) return;
  Series fit{.name = fmt::format("order {:.2f}", order), .x = {least, greatest}, .y = {}};
  fit.mark = Mark::kDashed;
  fit.colour = "ink";
  for (const double x : fit.x) fit.y.push_back(std::exp(sum / n + order * std::log(x)));
  plot.series.push_back(std::move(fit));
}

Plot frame_of(const Felt& q, const std::string& x_label) {
  Plot plot = log_log_plot(x_label, fmt::format("error of the {}, RMS [% of its peak]", q.name));
  plot.floor_y = q.peak > 0.0 ? 100.0 * q.own_error / q.peak : kUnknown;
  plot.floor_label = "reference error";
  return plot;
}

/// Returns whether a variable has a nonzero error to draw.
bool holds(const Table& table, const Felt& q, const std::string& variable) {
  return rows_where(table, "variable", variable).exceeds(q.of_peak, 0.0);
}

void add_charts(Page& page, const Table& table, const Felt& q, const Json& orders) {
  Plot period = frame_of(q, "exchange period [s]");
  for (const char* variable : {"exchange period", "exchange alone"})
    if (holds(table, q, variable)) period.series.push_back(series_of(table, q, variable, "setting", false));
  if (!period.series.empty())
    add_fit(period, period.series.back(),
            number_at(row_where(orders, "variable", "exchange alone"), (q.name + "_order").c_str()));
  add_plot(page, period, "haptic.csv",
           fmt::format("Error of the {} against the exchange period: at the settings of the scene, and with "
                       "only the errors of exchange and tick (a tenth of the period) left. Rings mark points "
                       "within 10 times the reference error.",
                       q.name));
  if (holds(table, q, "tick")) {
    Plot rate = frame_of(q, "haptic rate [ticks/s]");
    Series ticks = series_of(table, q, "tick", "setting", false);
    for (double& x : ticks.x) x = 1.0 / x;
    rate.series.push_back(std::move(ticks));
    add_plot(page, rate, "haptic.csv", fmt::format("Error of the {} against the haptic rate.", q.name));
  }
  for (const char* variable : {"pixels", "element size"}) {
    if (!holds(table, q, variable)) continue;
    Plot plot = frame_of(
        q, std::string(variable) == "pixels" ? "pixels along the image's longer edge" : "element size [m]");
    plot.series.push_back(series_of(table, q, variable, "setting", false));
    add_plot(page, plot, "haptic.csv",
             fmt::format("Error of the {} against the contact's resolution.", q.name));
  }
  Plot cost = frame_of(q, "CPU time of the loop [s]");
  cost.height = 520;
  for (const std::string& variable : distinct(table, "variable"))
    if (variable != "exchange alone" && holds(table, q, variable))
      cost.series.push_back(series_of(table, q, variable, "cpu_s_median", true));
  add_plot(page, cost, "haptic.csv",
           fmt::format("Error of the {} against CPU time, all variants; lower left is better.", q.name));
}

std::string percent(const Table& table, std::size_t row, const char* column) {
  const double value = to_number(table.cell(row, column));
  return std::isfinite(value) ? short_number(100.0 * value) : "-";
}

void add_variables(Page& page, const Table& table) {
  Rows rows;
  std::vector<RowMark> marks;
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const auto text = [&](const char* column) { return table.cell(r, column); };
    const bool ok = text("status") == "ok", ring = is_yes(text("force_unresolved"));
    rows.push_back({text("variable"), text("value") + (is_yes(text("own")) ? " (the scene's)" : ""),
                    cell_text(table, r, "force_error_rms_n"), percent(table, r, "force_error_rms_of_peak"),
                    percent(table, r, "force_error_max_of_peak"), cell_text(table, r, "torque_error_rms_n_m"),
                    percent(table, r, "torque_error_rms_of_peak"),
                    percent(table, r, "torque_error_max_of_peak"), cell_text(table, r, "cpu_s_median"),
                    cell_text(table, r, "contact_query_s"), cell_text(table, r, "linearise_s"),
                    cell_text(table, r, "tool_ticks_s"), cell_text(table, r, "bodies_s"),
                    !ok    ? (text("reason").empty() ? text("status") : text("reason"))
                    : ring ? "not resolved"
                           : "ok"});
    marks.push_back(!ok ? RowMark::kBad : ring ? RowMark::kFaint : RowMark::kNone);
  }
  page.add_table(
      {"variable", "", "force, RMS [N]", "[% of peak]", "largest [%]", "torque, RMS [N m]", "[% of peak]",
       "largest [%]", "CPU [s]", "queries [s]", "linearise [s]", "ticks [s]", "bodies [s]", "status"},
      rows, "“Not resolved”: within 10 times the reference error. All times except CPU are wall-clock times.",
      marks);
}

}  // namespace

void add_haptic(Page& page, const Table& table, const Json& summary) {
  if (table.rows.empty()) return;
  const Json reference = section_of(summary, "monolithic_reference"),
             orders = list_of(summary, "observed_orders");
  page.add_heading("Force on the hand against the monolithic solution");
  page.add_paragraph(
      "Two-rate solution of tool and bodies against the monolithic solution with the same motion of the "
      "hand; each variant changes one setting of the scene. Errors are those of the wrench that the device "
      "sends to the hand, at the common ticks, in percent of the peak of the reference.");
  if (const std::string made_by = text_at(reference, "made_by"); !made_by.empty())
    page.add_paragraph("Reference: " + made_by + ".");
  if (const std::string trouble = text_at(reference, "trouble"); !trouble.empty())
    page.add_paragraph("Note: " + trouble + ".");
  for (const Felt& q : {felt("force", "n", reference), felt("torque", "n_m", reference)})
    if (table.exceeds(q.error, kRounding)) add_charts(page, table, q, orders);
  add_variables(page, table);
}

}  // namespace palpate::report
