#include <algorithm>
#include <cmath>

#include "comparison_tables.h"
#include "palpate/core/error.h"
#include "report/cost_envelope.h"

namespace palpate::report {
namespace {

std::string order_text(const FittedOrder& fitted) {
  if (!std::isfinite(fitted.order)) return "-";
  return fmt::format("{:.2f} ({} points)", fitted.order, fitted.points);
}

constexpr std::size_t kMostRivals = 3;  ///< Most rivals that are listed by name

/// Returns the label of the winner, or the labels that cannot be ranked.
std::string winner_text(const Winner& win) {
  if (win.declared()) return win.label;
  if (std::isnan(win.cost.high)) return fmt::format("{}, but no run was repeated", win.label);
  const std::size_t named = std::min(kMostRivals, win.rivals.size());
  std::string out = "no winner: " + win.label;
  for (std::size_t i = 0; i < named; ++i) out += ", " + win.rivals[i];
  return win.rivals.size() > named ? fmt::format("{} and {} more", out, win.rivals.size() - named) : out;
}

}  // namespace

void add_orders_table(Page& page, const Table& compare, const std::vector<Quantity>& quantities) {
  std::vector<std::string> headers = {"integrator", "variable"};
  Rows rows;
  for (const Quantity& q : quantities) {
    headers.push_back(q.label);
    const std::vector<FittedOrder> orders = fitted_orders(compare, q.column, q.scale);
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
                 "is proportional to the tolerance). Points within 10 times the reference error are "
                 "excluded.");
}

void add_winners_table(Page& page, const Table& compare, const Quantity& q, double scale,
                       const std::string& cost_column, const std::string& cost_label, bool explained) {
  Rows rows;
  const std::vector<Winner> all = winners(compare, q.column, cost_column, targets_of(scale), q.reference);
  for (std::size_t i = 0; i < all.size(); ++i)
    rows.push_back(winner_row(all[i], kTargets[i], winner_text(all[i])));
  page.add_table(
      {scale == 1.0 ? "position error" : "force error / peak", "cheapest", cost_label, "range", "runner-up",
       "runner-up / cheapest", kBaseline + " / cheapest"},
      rows,
      !explained
          ? ""
          : "Interpolated in log cost against log error on the monotone envelopes of each refinement "
            "sequence, without extrapolation and not across failed levels. “Range”: spread over repeats and "
            "over levels that deviate from the trend. No winner: the ranges overlap. “<=”: the coarsest "
            "usable level is more accurate than the target; its cost is an upper bound.");
}

void add_costs_table(Page& page, const Table& compare, double reference_error) {
  const std::vector<Ladder> all = ladders(compare, kPosition, "cpu_s_median");
  const std::vector<FittedOrder> orders = fitted_orders(compare, kPosition);
  std::vector<double> best(kTargets.size(), kUnknown);
  for (const Ladder& ladder : all)
    for (std::size_t t = 0; t < kTargets.size(); ++t)
      best[t] = std::fmin(best[t], cost_at(ladder, kTargets[t], reference_error).value);  // NaN: no cost
  std::vector<std::string> headers = {"integrator", "family", "theoretical order", "fitted", "variable"};
  for (const double target : kTargets)
    headers.push_back(fmt::format("CPU [s] at {:g}", target)), headers.push_back("ratio");
  Rows rows;
  std::vector<RowMark> marks;
  for (std::size_t i = 0; i < all.size(); ++i) {
    rows.push_back({all[i].label, all[i].family, all[i].order > 0 ? std::to_string(all[i].order) : "-",
                    order_text(orders[i]), orders[i].setting_name == "rtol" ? "rtol" : "step"});
    for (std::size_t t = 0; t < kTargets.size(); ++t) {
      const Cost cost = cost_at(all[i], kTargets[t], reference_error);
      rows.back().push_back(cost_text(cost));
      rows.back().push_back(ratio_text({cost.value / best[t]}));
    }
    marks.push_back(all[i].points.empty() ? RowMark::kBad : RowMark::kNone);
  }
  page.add_table(headers, rows,
                 "“Ratio”: cost divided by the lowest cost at that error. Red: no usable point.", marks);
}

}  // namespace palpate::report
