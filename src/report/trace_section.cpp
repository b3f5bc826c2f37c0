#include <algorithm>
#include <cmath>
#include <map>

#include "palpate/core/error.h"
#include "report/trace.h"
#include "sections.h"

namespace palpate::report {
namespace {

constexpr const char* kAccepted = "accepted";

/// Returns the most frequent directions with their counts, as table rows.
Rows most_frequent(const std::map<std::string, long>& counts, std::size_t most) {
  std::vector<std::pair<std::string, long>> sorted(counts.begin(), counts.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  Rows rows;
  for (std::size_t i = 0; i < std::min(most, sorted.size()); ++i)
    rows.push_back({sorted[i].first, std::to_string(sorted[i].second)});
  return rows;
}

std::string worst_of(const Table& trace, std::size_t row) {
  const auto cell = [&](const char* column) { return trace.cell(row, column); };
  if (cell("worst_body").empty()) return "";
  return fmt::format("{}{}, {}", cell("worst_body"),
                     cell("worst_node").empty() ? "" : ", node " + shown_cell(cell("worst_node")),
                     cell("worst_axis"));
}

}  // namespace

Plot step_plot(const Table& trace) {
  const std::vector<double> time = trace.numbers("time_s"), step = trace.numbers("step_s");
  const std::size_t outcome = trace.column("outcome");
  Plot plot;
  plot.x_label = "time [s]";
  plot.y_label = "step size [s]";
  plot.log_y = true;
  const auto series_of = [&](const std::string& which, Mark mark) {
    Series series{.name = which, .x = {}, .y = {}, .mark = mark};
    for (std::size_t i = 0; i < trace.rows.size(); ++i) {
      if (trace.rows[i][outcome] != which) continue;
      series.x.push_back(time[i]);
      series.y.push_back(step[i]);
    }
    return series;
  };
  plot.series.push_back(series_of(kAccepted, Mark::kLine));
  plot.series[0].colour = kPalette[10];
  const std::map<std::string, std::string_view> colours = {{"error test", kPalette[4]},
                                                           {"Newton", kPalette[3]},
                                                           {"not finite", kPalette[1]},
                                                           {"event", kPalette[0]}};
  for (const std::string& which : distinct(trace, "outcome")) {
    if (which == kAccepted) continue;
    plot.series.push_back(series_of(which, Mark::kPoints));
    if (const auto colour = colours.find(which); colour != colours.end())
      plot.series.back().colour = colour->second;
  }
  return plot;
}

void add_trace(Page& page, const Table& trace) {
  page.add_heading("Steps and causes of rejection");
  const std::size_t outcome = trace.column("outcome"), inverted = trace.column("inverted_body");
  std::map<std::string, long> outcomes, worst_rejected, worst_accepted, inverted_in;
  for (std::size_t i = 0; i < trace.rows.size(); ++i) {
    const std::string& what = trace.rows[i][outcome];
    ++outcomes[what];
    if (const std::string where = worst_of(trace, i); !where.empty())
      ++(what == kAccepted ? worst_accepted : worst_rejected)[where];
    if (const std::string& body = trace.rows[i][inverted]; !body.empty()) ++inverted_in[body];
  }
  add_plot(page, step_plot(trace), "trace.csv",
           "Step size over time: the line shows accepted steps, points show rejected attempts, coloured by "
           "cause (an event ends a step at a root).");
  page.add_table({"outcome", "attempts"}, most_frequent(outcomes, outcomes.size()));
  if (!worst_rejected.empty())
    page.add_table({"location of the largest error in rejected steps", "count"},
                   most_frequent(worst_rejected, 10));
  if (!worst_accepted.empty())
    page.add_table({"location of the largest error in accepted steps", "count"},
                   most_frequent(worst_accepted, 10));
  if (!inverted_in.empty())
    page.add_table({"location of inverted elements in attempted steps", "count"},
                   most_frequent(inverted_in, 10));
}

}  // namespace palpate::report
