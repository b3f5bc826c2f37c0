#include "work_precision_plots.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "log_line.h"
#include "palpate/core/error.h"

namespace palpate::report {
namespace {

/// Returns whether an error is drawn; always true for an unknown (NaN) scale.
bool is_drawn(double error, double scale) { return !(error > kLargestDrawn * scale); }

/// Most refinement sequences of a plot whose points have their setting as a label.
constexpr std::size_t kFewLadders = 3;
/// Most sequences of a family in one plot; larger families are plotted by order.
constexpr std::size_t kManyInFamily = 6;

std::map<std::string, std::string> family_colours(const std::vector<Ladder>& all) {
  std::map<std::string, std::string> out;
  for (const Ladder& ladder : all)
    if (!out.contains(ladder.family)) out.emplace(ladder.family, kPalette[out.size() % kPalette.size()]);
  return out;
}

Series line_of(const Ladder& ladder, double scale, bool labelled) {
  Series series{.name = ladder.label, .x = {}, .y = {}, .mark = Mark::kLinePoints};
  series.reading = ladder.label;
  for (const LadderPoint& p : ladder.points) {
    if (!is_drawn(p.error, scale)) continue;
    series.x.push_back(p.cost);
    series.y.push_back(p.error);
    series.notes.push_back(setting_text(ladder.setting_name, p.setting));
    if (labelled) series.labels.push_back(series.notes.back());
    series.hollow.push_back(p.unresolved);
  }
  return series;
}

/// Returns the Pareto front in cost and error, from cheap to accurate; each sequence is labelled at its first
/// point on the front.
Series best_envelope(const std::vector<Ladder>& all, double scale) {
  struct Entry {
    double cost, error;
    const Ladder* ladder;
  };
  std::vector<Entry> entries;
  for (const Ladder& ladder : all)
    for (const LadderPoint& p : ladder.points)
      if (p.cost > 0.0 && p.error > 0.0 && is_drawn(p.error, scale) && !p.unresolved)
        entries.push_back({p.cost, p.error, &ladder});
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.error < b.error;
  });
  Series out{
      .name = "Pareto front", .x = {}, .y = {}, .mark = Mark::kLine, .labels_below = true, .colour = "ink"};
  double least = std::numeric_limits<double>::infinity();
  std::set<const Ladder*> named;
  for (const Entry& e : entries) {
    if (!(e.error < least)) continue;
    least = e.error;
    out.x.push_back(e.cost);
    out.y.push_back(e.error);
    out.labels.push_back(named.insert(e.ladder).second ? e.ladder->label : "");
  }
  return out;
}

Plot frame_of(const std::string& error_label, double reference_error, const std::string& cost_label) {
  Plot plot = log_log_plot(cost_label, error_label);
  plot.floor_y = reference_error;
  plot.floor_label = "reference error";
  return plot;
}

}  // namespace

int points_not_drawn(const Table& compare, const std::string& error_column, double scale) {
  int count = 0;
  for (const Ladder& ladder : ladders(compare, error_column, "setting"))
    for (const LadderPoint& p : ladder.points) count += !is_drawn(p.error, scale);
  return count;
}

Plot work_precision_plot(const Table& compare, const std::string& error_column,
                         const std::string& error_label, double reference_error, double scale,
                         const std::string& cost_column, const std::string& cost_label) {
  const std::vector<Ladder> all = ladders(compare, error_column, cost_column);
  Plot plot = frame_of(error_label, reference_error, cost_label);
  if (all.size() <= kFewLadders) {
    for (const Ladder& ladder : all) plot.series.push_back(line_of(ladder, scale, true));
    return plot;
  }
  plot.height = 520;
  const auto colours = family_colours(all);
  std::map<std::string, bool> named;
  for (const Ladder& ladder : all) {
    Series series = line_of(ladder, scale, false);
    const bool drawn = std::any_of(series.x.begin(), series.x.end(), [](double x) { return x > 0.0; });
    series.name = !drawn || named[ladder.family] ? "" : ladder.family;
    series.group = ladder.family;
    named[ladder.family] |= drawn;
    series.colour = colours.at(ladder.family);
    series.width = 1.0;
    plot.series.push_back(std::move(series));
  }
  plot.series.push_back(best_envelope(all, scale));
  return plot;
}

std::vector<Plot> family_plots(const Table& compare, const std::string& error_column,
                               const std::string& error_label, double reference_error, double scale,
                               const std::string& cost_column, const std::string& cost_label) {
  const std::vector<Ladder> all = ladders(compare, error_column, cost_column);
  std::map<std::string, std::size_t> sizes;
  for (const Ladder& ladder : all) ++sizes[ladder.family];
  const auto panel_of = [&](const Ladder& ladder) {
    return sizes[ladder.family] > kManyInFamily && ladder.order > 0
               ? fmt::format("{}, order {}", ladder.family, ladder.order)
               : ladder.family;
  };
  std::vector<std::string> panels;
  for (const Ladder& ladder : all)
    if (!ladder.points.empty() && std::find(panels.begin(), panels.end(), panel_of(ladder)) == panels.end())
      panels.push_back(panel_of(ladder));
  std::vector<Plot> out;
  for (const std::string& panel : panels) {
    Plot plot = frame_of(error_label, reference_error, cost_label);
    plot.title = panel;
    plot.floor_label = "";
    for (const Ladder& ladder : all) {
      if (panel_of(ladder) == panel) continue;
      Series series = line_of(ladder, scale, false);
      series.name = "";
      series.reading.clear();
      series.notes.clear();
      series.mark = Mark::kLine;
      series.hollow.clear();
      series.colour = "faint";
      series.width = 0.7;
      plot.series.push_back(std::move(series));
    }
    for (const Ladder& ladder : all)
      if (panel_of(ladder) == panel) plot.series.push_back(line_of(ladder, scale, false));
    out.push_back(std::move(plot));
  }
  return out;
}

Plot exchange_plot(const Table& exchange, const std::string& error_column, const std::string& error_label) {
  const std::vector<double> period = exchange.numbers("exchange_period_s"),
                            error = exchange.numbers(error_column);
  Plot plot = log_log_plot("exchange period [s]", error_label);
  plot.height = 340;
  plot.series.push_back({.name = "measured", .x = period, .y = error, .mark = Mark::kLinePoints});
  std::vector<double> resolved = error;  // the fit ignores NaN
  if (const std::string below = below_column(exchange, error_column); exchange.has(below))
    for (std::size_t i = 0; i < resolved.size(); ++i)
      if (exchange.cell(i, below) == "yes") resolved[i] = kUnknown;
  const LogLine line = fit_log_line(period, resolved);
  if (std::isfinite(line.slope)) {
    const auto [least, greatest] = std::minmax_element(period.begin(), period.end());
    Series fit{.name = fmt::format("fitted order {:.2f}", line.slope),
               .x = {*least, *greatest},
               .y = {},
               .mark = Mark::kDashed,
               .colour = "ink"};
    for (const double x : fit.x) fit.y.push_back(std::exp(line.intercept + line.slope * std::log(x)));
    plot.series.push_back(std::move(fit));
  }
  return plot;
}

Plot restart_plot(const Table& restarts, const std::string& count_column, const std::string& count_label) {
  const std::vector<double> refresh = restarts.numbers("contact_refresh_s"),
                            count = restarts.numbers(count_column),
                            simulated = restarts.numbers("simulated_s");
  const std::size_t label = restarts.column("label"), multistep = restarts.column("multistep"),
                    status = restarts.column("status");
  Plot plot = log_log_plot("contact refreshes per simulated second", count_label);
  plot.height = 400;
  for (const std::string& name : distinct(restarts, "label")) {
    Series series{.name = name, .x = {}, .y = {}, .mark = Mark::kLinePoints};
    bool many = false;
    for (std::size_t i = 0; i < restarts.rows.size(); ++i) {
      if (restarts.rows[i][label] != name || restarts.rows[i][status] != "ok") continue;
      many = restarts.rows[i][multistep] == "yes";
      series.x.push_back(1.0 / refresh[i]);
      series.y.push_back(count[i] / simulated[i]);
    }
    series.name += many ? " (multistep)" : " (one-step)";
    if (!many) series.mark = Mark::kDashed;
    plot.series.push_back(std::move(series));
  }
  return plot;
}

}  // namespace palpate::report
