#include <algorithm>
#include <cmath>
#include <sstream>

#include "comparison_cells.h"
#include "palpate/core/error.h"
#include "palpate/store/study_columns.h"
#include "sections.h"

namespace palpate::report {
namespace {

bool is_yes(const std::string& cell) { return cell == "true" || cell == "1" || cell == "yes"; }

std::string point_text(const Table& compare, std::size_t row) {
  return setting_text(compare.rows[row][compare.column("setting_name")],
                      to_number(compare.rows[row][compare.column("setting")]));
}

/// Achieved over wanted error of a point that is steered by a tolerance.
std::string achieved_text(const Table& compare, std::size_t row) {
  if (compare.rows[row][compare.column("setting_name")] != "rtol") return "-";
  const double error = to_number(compare.rows[row][compare.column("position_error_rel_l2")]),
               wanted = to_number(compare.rows[row][compare.column("setting")]);
  return std::isfinite(error) ? short_number(error / wanted) : "-";
}

void add_points_table(Page& page, const Table& compare) {
  std::vector<std::vector<std::string>> rows;
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
  page.add_table(
      {"integrator", "setting", "its error test", "position error / rtol", "position error, rel. L2",
       "force error, RMS [N]", "torque error, RMS [N m]", "energy error [J]", "CPU [s], median",
       "CPU [s], least – most", "runs", "linear solver", "held against", "status"},
      rows,
      "“Below reference”: the error is within ten times the reference's own, and says no more than that.",
      marks);
}

/// One line a point, under the columns of compare.csv that are named.
void add_columns_table(Page& page, const Table& compare,
                       const std::vector<std::pair<std::string, std::string>>& columns,
                       const std::string& caption) {
  std::vector<std::string> headers = {"integrator", "setting"};
  for (const auto& [column, header] : columns) headers.push_back(header);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t r = 0; r < compare.rows.size(); ++r) {
    rows.push_back({compare.rows[r][compare.column("label")], point_text(compare, r)});
    for (const auto& [column, header] : columns) rows.back().push_back(cell_text(compare, r, column));
  }
  page.add_table(headers, rows, caption);
}

/// The counts that follow the known columns of compare.csv, where any point has one that is not zero.
std::vector<std::pair<std::string, std::string>> further_counts(const Table& compare) {
  const std::vector<std::string>& known = store::compare_columns();
  std::vector<std::pair<std::string, std::string>> out;
  for (const std::string& column : compare.headers) {
    if (column.ends_with("_s") || std::find(known.begin(), known.end(), column) != known.end()) continue;
    const std::vector<double> counts = compare.numbers(column);
    if (std::none_of(counts.begin(), counts.end(), [](double count) { return count > 0.0; })) continue;
    std::string words = column;
    std::replace(words.begin(), words.end(), '_', ' ');
    out.emplace_back(column, words);
  }
  return out;
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
  add_columns_table(page, compare, counts, "Counts, which no noise of the machine touches.");
  add_columns_table(page, compare,
                    {{"cpu_s_median", "all but set-up and recording, median"},
                     {"method_s", "the method"},
                     {"contact_query_s", "contact queries"},
                     {"linearise_s", "linearisation for the tool"},
                     {"tool_ticks_s", "the tool's ticks"},
                     {"setup_s", "set-up"},
                     {"record_s", "recording, with the bodies' energy"}},
                    "Where the time went, of the first repeat [s].");
  add_columns_table(page, compare,
                    {{"position_error_max_m", "position error [m]"},
                     {"force_error_max_n", "force error [N]"},
                     {"torque_error_max_n_m", "torque error [N m]"}},
                    "The largest errors over all nodes and times.");
}

/// The error column that decides: positions, or else forces.
constexpr const char* kPosition = "position_error_rel_l2";

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
      for (const FittedOrder& f : orders)
        rows.push_back({f.label, f.setting_name == "step_s"   ? "step"
                                 : f.setting_name == "tick_s" ? "tick"
                                                              : f.setting_name});
    for (std::size_t i = 0; i < orders.size(); ++i) rows[i].push_back(order_text(orders[i]));
  }
  page.add_heading("Fitted order", 3);
  page.add_table(headers, rows,
                 "Least-squares slope of log error against log step (or tolerance: 1 means that the error "
                 "follows the tolerance). Points within 10 times of the reference's own error are left out.");
}

/// The winner at each target error, by a cost.  @param scale  what the targets are shares of
void add_winners_table(Page& page, const Table& compare, const Quantity& q, double scale,
                       const std::string& cost_column, const std::string& cost_label) {
  std::vector<std::vector<std::string>> rows;
  std::vector<double> targets = kTargets;
  for (double& target : targets) target *= scale;
  const std::vector<Winner> all = winners(compare, q.column, cost_column, targets, q.reference);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Winner& win = all[i];
    const std::string target = fmt::format("{:g}", kTargets[i]);
    if (!win.found) {
      rows.push_back(
          {target, win.resolved ? "none reaches it" : "the reference cannot tell", "-", "-", "-", "-", "-"});
      continue;
    }
    const std::string winner =
        win.declared() ? win.label : fmt::format("no winner: {}, {}", win.label, fmt::join(win.rivals, ", "));
    rows.push_back({target, winner, cost_text(win.cost), spread_text(win.cost),
                    win.runner_up.empty() ? "-" : win.runner_up, ratio_text(win.runner_up_ratio),
                    ratio_text(win.baseline_ratio)});
  }
  page.add_table(
      {scale == 1.0 ? "position error" : "force error / peak", "cheapest", cost_label, "from, to",
       "runner-up", "runner-up / cheapest", kBaseline + " / cheapest"},
      rows,
      "Log cost against log error on each ladder's monotone envelopes, never extrapolated nor across rungs "
      "that failed. “From, to”: by the spread of repeats, and of rungs that lie out of line. No winner: the "
      "spreads overlap. “<=”: the coarsest usable rung is better than asked for, and costs this much.");
}

/// The cost of each integrator at each target error, with its fitted order.
void add_costs_table(Page& page, const Table& compare, double reference_error) {
  const std::vector<Ladder> all = ladders(compare, kPosition, "cpu_s_median");
  const std::vector<FittedOrder> orders = fitted_orders(compare, kPosition);
  std::vector<double> best(kTargets.size(), kUnknown);
  for (const Ladder& ladder : all)
    for (std::size_t t = 0; t < kTargets.size(); ++t)
      if (const double value = cost_at(ladder, kTargets[t], reference_error).value; !(value >= best[t]))
        best[t] = value;
  std::vector<std::string> headers = {"integrator", "family", "order in theory", "fitted", "against"};
  for (const double target : kTargets)
    headers.push_back(fmt::format("CPU [s] at {:g}", target)), headers.push_back("of the best");
  std::vector<std::vector<std::string>> rows;
  std::vector<RowMark> marks;
  for (std::size_t i = 0; i < all.size(); ++i) {
    rows.push_back({all[i].label, all[i].family, all[i].order > 0 ? std::to_string(all[i].order) : "-",
                    order_text(orders[i]), orders[i].setting_name == "rtol" ? "rtol" : "step"});
    for (std::size_t t = 0; t < kTargets.size(); ++t) {
      const Cost cost = cost_at(all[i], kTargets[t], reference_error);
      rows.back().push_back(cost_text(cost));
      rows.back().push_back(std::isnan(cost.value) ? "-" : fmt::format("{:.2f}", cost.value / best[t]));
    }
    marks.push_back(all[i].points.empty() ? RowMark::kBad : RowMark::kNone);
  }
  page.add_table(headers, rows, "“Of the best”: times the cheapest cost at that error. Red: no usable point.",
                 marks);
}

constexpr const char* kCosts[][2] = {{"force_evaluations", "force evaluations"},
                                     {"factorisations", "factorisations"}};

void add_work_precision(Page& page, const Table& compare, const Quantity& q) {
  const bool many = ladders(compare, q.column, "cpu_s_median").size() > 3;
  add_plot(page, work_precision_plot(compare, q.column, q.label, q.reference),
           capitalised(q.label) + " against CPU time; down and to the left is better. " +
               (many ? "One line a ladder, coloured by family; the dark line joins the points that none "
                       "beats, named where another integrator takes over. "
                     : "Each point carries its relative tolerance or its step. ") +
               "Rings lie within 10 times of the reference's own error" +
               (std::isfinite(q.reference) ? fmt::format(" of {}.", short_number(q.reference)) : ".") +
               " Errors above 3 are left out.");
  if (many && q.column == kPosition) {
    page.begin_multiples();
    for (const Plot& plot : family_plots(compare, q.column, q.label, q.reference)) add_plot(page, plot, "");
    page.end_multiples();
  }
  for (const auto& [column, label] : kCosts) {
    const std::vector<double> values = compare.numbers(column);
    if (!std::any_of(values.begin(), values.end(), [](double v) { return v > 0.0; })) continue;
    add_plot(
        page, work_precision_plot(compare, q.column, q.label, q.reference, column, label),
        fmt::format("The same against {}, which no noise of the machine touches.{}", label,
                    std::string(column) == "factorisations" ? " What factors no matrix is not here." : ""));
  }
}

/// Everything about one scene.
void add_scene_comparison(Page& page, const Table& compare, const ReferenceError& reference) {
  if (!reference.description.empty())
    page.add_paragraph("Reference: " + reference.description +
                       (std::isfinite(reference.position_error_rel_l2)
                            ? fmt::format("; the two differ by {}, which is taken as its own error.",
                                          short_number(reference.position_error_rel_l2))
                            : "."));
  if (!reference.trouble.empty()) page.add_paragraph("Mind: " + reference.trouble + ".");
  std::istringstream words(in_words(compare, reference));
  for (std::string paragraph; std::getline(words, paragraph);) page.add_paragraph(paragraph);
  const std::vector<Quantity> quantities = quantities_of(compare, reference);
  for (const Quantity& q : quantities) add_work_precision(page, compare, q);
  if (const std::vector<double> torque = compare.has("torque_error_max_n_m")
                                             ? compare.numbers("torque_error_max_n_m")
                                             : std::vector<double>{};
      !torque.empty() && *std::max_element(torque.begin(), torque.end()) <= kRounding)
    page.add_paragraph("No torque: its largest error is rounding, for this scene makes none.");
  if (quantities.empty()) page.add_paragraph("No point of the comparison has a measured error.");
  if (std::isfinite(reference.position_error_rel_l2)) {
    page.add_heading("Cheapest for a wanted error", 3);
    for (const Quantity& q : quantities) {
      const double scale = q.column == kPosition             ? 1.0
                           : q.column == "force_error_rms_n" ? reference.peak_force_n
                                                             : kUnknown;
      if (!std::isfinite(scale)) continue;
      add_winners_table(page, compare, q, scale, "cpu_s_median", "CPU [s]");
      add_winners_table(page, compare, q, scale, "force_evaluations", "force evaluations");
    }
    page.add_heading("Cost of a wanted error", 3);
    add_costs_table(page, compare, reference.position_error_rel_l2);
  }
  if (!quantities.empty()) add_orders_table(page, compare, quantities);
  page.add_heading("All points", 3);
  const bool folded = compare.rows.size() > 40;
  if (folded)
    page.begin_details(fmt::format("{} points, with their counts and largest errors", compare.rows.size()));
  add_points_table(page, compare);
  add_counts_and_maxima(page, compare);
  if (folded) page.end_details();
  for (const std::string& note : reference.notes) page.add_paragraph("Mind: " + note + ".");
}

}  // namespace

void add_comparison(Page& page, const Table& compare, const std::map<std::string, ReferenceError>& references,
                    const std::string& rules) {
  page.add_heading("Error against run time");
  if (!rules.empty()) page.add_paragraph(rules);
  const std::vector<std::string> scenes = distinct(compare, "scene");
  for (const std::string& scene : scenes) {
    if (scenes.size() > 1) page.add_heading("Scene: " + scene);
    const auto reference = references.find(scene);
    add_scene_comparison(page, rows_where(compare, "scene", scene),
                         reference == references.end() ? ReferenceError{} : reference->second);
  }
}

}  // namespace palpate::report
