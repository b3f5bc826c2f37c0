#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "answers.h"
#include "comparison_cells.h"
#include "palpate/core/error.h"
#include "sections.h"
#include "study_columns.h"

/// Section for study.csv of `palpate study`.
namespace palpate::report {
namespace {

constexpr std::size_t kMostRows = 2000;  ///< Most rows of a table on the page
constexpr std::size_t kMostSeries = 12;  ///< Most series of a readable chart
constexpr double kLogRatio = 30.0;       ///< Least ratio of two values for a logarithmic axis

struct SeedSpread {
  double n = 0.0, sum = 0.0, square = 0.0, least = HUGE_VAL, greatest = -HUGE_VAL;
  void add(double value) {
    if (!std::isfinite(value)) return;
    n += 1.0, sum += value, square += value * value;
    least = std::min(least, value), greatest = std::max(greatest, value);
  }
  double mean() const { return sum / n; }
  /// Standard deviation of the sample; 0 for one value
  double deviation() const {
    return n > 1.0 ? std::sqrt(std::max(0.0, (square - sum * sum / n) / (n - 1.0))) : 0.0;
  }
};

bool is_ok(const Table& study, std::size_t row) { return study.cell(row, "status") == "ok"; }

/// Numeric parameter for the x axis of a chart, and the settings that do not define its series.
struct Abscissa {
  std::string column;
  std::vector<std::string> without;  ///< Settings that do not distinguish series
};
std::optional<Abscissa> abscissa_of(const Table& study, const StudyColumns& columns) {
  const auto usable = [&](const std::string& name) {
    return distinct(study, name).size() > 1 && is_numeric_column(study.rows, study.column(name));
  };
  std::vector<std::string> of_seed = columns.drawn;
  of_seed.emplace_back("seed");
  for (const auto* list : {&columns.swept, &columns.drawn})
    for (const std::string& name : *list) {
      if (!usable(name)) continue;
      Abscissa out{name, of_seed};
      out.without.push_back(name);
      if (groups_of(study, columns, out.without).size() <= kMostSeries) return out;
    }
  return {};
}

/// Adds the mean over seeds at each value and, if there are seeds, a point for each of them.
void add_series(Plot& plot, const Table& study, const StudyGroup& group, const std::vector<double>& x,
                const std::vector<double>& y, bool drawn, const std::string& colour) {
  std::map<double, SeedSpread> at;
  Series points{.name = "", .x = {}, .y = {}};
  points.mark = Mark::kPoints;
  points.group = group.name;
  for (const std::size_t r : group.rows) {
    if (!is_ok(study, r) || !std::isfinite(x[r]) || !std::isfinite(y[r])) continue;
    at[x[r]].add(y[r]);
    points.x.push_back(x[r]);
    points.y.push_back(y[r]);
  }
  if (at.empty()) return;
  points.colour = colour;
  if (drawn) {
    points.name = group.name;
    plot.series.push_back(std::move(points));
    return;
  }
  Series mean{.name = group.name, .x = {}, .y = {}};
  mean.mark = Mark::kLinePoints;
  mean.colour = colour;
  const bool several = std::any_of(at.begin(), at.end(), [](const auto& one) { return one.second.n > 1.0; });
  for (const auto& [value, spread] : at) mean.x.push_back(value), mean.y.push_back(spread.mean());
  plot.series.push_back(std::move(mean));
  if (several) plot.series.push_back(std::move(points));
}

/// Returns the sum of the squares of the gaps between ascending values, in units of their range; the minimum
/// 1 / (n - 1) is reached with equal gaps.
double unevenness(const std::vector<double>& values) {
  const double range = values.back() - values.front();
  double sum = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) sum += std::pow((values[i] - values[i - 1]) / range, 2);
  return sum;
}

/// Returns whether a parameter has a logarithmic axis: if the study specifies it (`declared`), or if its
/// values are more evenly spaced on it. Two values are equally even on both axes; then their ratio decides
/// (kLogRatio).
bool is_logarithmic(std::vector<double> values, bool declared) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (values.size() < 2 || values.front() <= 0.0) return false;
  if (declared) return true;
  if (values.size() == 2) return values.back() >= kLogRatio * values.front();
  std::vector<double> logs;
  for (const double value : values) logs.push_back(std::log(value));
  return unevenness(logs) < unevenness(values);
}

/// Returns whether the figures of a chart span decades, all of them positive; a logarithmic axis leaves out
/// other values.
bool spans_decades(const std::vector<Series>& series) {
  double least = HUGE_VAL, greatest = 0.0;
  for (const Series& one : series)
    for (const double y : one.y) least = std::min(least, y), greatest = std::max(greatest, y);
  return least > 0.0 && greatest >= kLogRatio * least;
}

void add_charts(Page& page, const Table& study, const StudyColumns& columns, const Json& summary) {
  const auto abscissa = abscissa_of(study, columns);
  if (!abscissa) return;
  const std::string& name = abscissa->column;
  const bool drawn = std::find(columns.drawn.begin(), columns.drawn.end(), name) != columns.drawn.end();
  const std::vector<double> x = study.numbers(name);
  const bool declared = !row_where(list_of(summary, "log_spaced_parameters"), "key", name).empty(),
             logarithmic = is_logarithmic(x, declared);
  const std::vector<StudyGroup> groups = groups_of(study, columns, abscissa->without);
  page.begin_multiples();
  for (const StudyFigure& figure : shown_figures(study)) {
    Plot plot;
    plot.x_label = parameter_text(name);
    plot.y_label = figure.label;
    plot.log_x = logarithmic;
    for (std::size_t g = 0; g < groups.size(); ++g)
      add_series(plot, study, groups[g], x, study.numbers(figure.column), drawn,
                 std::string(kPalette[g % kPalette.size()]));
    if (plot.series.empty()) continue;
    plot.log_y = spans_decades(plot.series);
    add_plot(
        page, plot, "study.csv",
        capitalised(figure.label) + " over " + plot.x_label + (logarithmic ? ", logarithmic axis" : "") +
            (columns.seeds && !drawn ? "; lines are means over the seeds, points are single seeds." : "."));
  }
  page.end_multiples();
}

/// Returns mean and deviation of a group, as "0.417 ± 0.0038"; "-" if no task of the group reached its end.
std::string spread_text(const Table& study, const StudyGroup& group, const std::vector<double>& values) {
  SeedSpread spread;
  for (const std::size_t r : group.rows)
    if (is_ok(study, r)) spread.add(values[r]);
  if (spread.n < 1.0) return "-";
  if (!(spread.least < spread.greatest)) return short_number(spread.least);
  return fmt::format("{} ± {}", short_number(spread.mean()), short_number(spread.deviation()));
}

/// Adds the spread over seeds, for each group of tasks that differ only by their seed.
void add_spreads(Page& page, const Table& study, const StudyColumns& columns) {
  if (!columns.seeds) return;
  std::vector<std::string> without = columns.drawn, headers = {"tasks"};
  without.emplace_back("seed");
  const std::vector<StudyFigure> figures = shown_figures(study);
  for (const StudyFigure& figure : figures) headers.push_back(figure.label);
  Rows rows;
  for (const StudyGroup& group : groups_of(study, columns, without)) {
    if (rows.size() == kMostRows) break;
    rows.push_back({group.name.empty() ? "all" : group.name});
    for (const StudyFigure& figure : figures)
      rows.back().push_back(spread_text(study, group, study.numbers(figure.column)));
  }
  page.add_heading("Spread over the seeds", 3);
  page.add_paragraph(
      "Mean and sample standard deviation of each figure over the seeds. Tasks that did not finish are "
      "excluded.");
  page.add_table(headers, rows);
}

void add_tables(Page& page, const Table& study, const StudyColumns& columns) {
  std::vector<std::string> first = {"task"}, headers;
  for (const std::string& name : columns.settings)
    if (study.rows.size() == 1 || distinct(study, name).size() > 1) first.push_back(name);
  first.emplace_back("status");
  headers = first;
  for (const StudyFigure& figure : shown_figures(study)) {
    first.push_back(figure.column);
    headers.push_back(figure.label);
  }
  first.emplace_back("reason");
  headers.emplace_back("reason");
  page.add_heading("Tasks", 3);
  std::vector<RowMark> marks;
  for (std::size_t r = 0; r < std::min(kMostRows, study.rows.size()); ++r)
    marks.push_back(is_ok(study, r) ? RowMark::kNone : RowMark::kBad);
  page.add_table(headers, cells_of(study, first, kMostRows), "", marks);
  if (study.rows.size() > kMostRows)
    page.add_paragraph(
        fmt::format("The first {} of {} tasks; study.csv lists all.", kMostRows, study.rows.size()));
  page.begin_details("All figures of all tasks");
  std::vector<std::string> all;
  for (const std::string& column : study.headers) all.push_back(key_text(column));
  page.add_table(all, cells_of(study, study.headers, kMostRows));
  page.end_details();
}

}  // namespace

Table with_times(Table study, const Table& times) {
  if (times.rows.size() != study.rows.size() || !times.has("loop_cpu_s")) return study;
  const std::size_t cpu = times.column("loop_cpu_s");
  study.headers.emplace_back("cpu_s");
  for (std::size_t r = 0; r < study.rows.size(); ++r) study.rows[r].push_back(times.rows[r][cpu]);
  return study;
}

void add_study(Page& page, const Table& study, const std::string& text, const Json& summary) {
  if (study.rows.empty()) return;
  const StudyColumns columns = columns_of_study(study);
  page.add_heading("Study");
  add_charts(page, study, columns, summary);
  add_spreads(page, study, columns);
  add_tables(page, study, columns);
  if (!text.empty()) page.begin_details("Study file").add_code(text).end_details();
}

Answer study_answer(const Table& study) {
  Answer out;
  if (study.rows.empty()) return out;
  std::map<std::string, std::size_t> count;
  for (const auto& row : study.rows) ++count[row[study.column("status")]];
  const std::size_t ok = count["ok"];
  if (ok == study.rows.size()) {
    out.lead = fmt::format("All {} tasks finished.", ok);
  } else {
    std::string others;
    for (const auto& [status, n] : count)
      if (status != "ok") others += fmt::format("{}{} {}", others.empty() ? "" : ", ", n, status);
    out.lead = fmt::format("{} of {} tasks finished; {}.", ok, study.rows.size(), others);
  }
  std::map<std::string, bool> explained;  // the first reason of each status
  for (std::size_t r = 0; r < study.rows.size(); ++r) {
    const std::string status = study.cell(r, "status"),
                      reason = study.has("reason") ? study.cell(r, "reason") : "";
    if (status == "ok" || reason.empty() || std::exchange(explained[status], true)) continue;
    out.points.push_back(fmt::format("{}, task {}: {}", status, r, reason.substr(0, reason.find('\n'))));
  }
  for (const StudyFigure& figure : shown_figures(study)) {
    const std::vector<double> values = study.numbers(figure.column);
    std::size_t least = values.size(), greatest = values.size();
    for (std::size_t r = 0; r < values.size(); ++r) {
      if (!is_ok(study, r) || !std::isfinite(values[r])) continue;
      if (least == values.size() || values[r] < values[least]) least = r;
      if (greatest == values.size() || values[r] > values[greatest]) greatest = r;
    }
    if (least < values.size() && values[least] < values[greatest])
      out.points.push_back(fmt::format("{}: from {} (task {}) to {} (task {}).", capitalised(figure.label),
                                       short_number(values[least]), least, short_number(values[greatest]),
                                       greatest));
  }
  return out;
}

}  // namespace palpate::report
