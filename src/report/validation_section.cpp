#include <algorithm>
#include <cmath>
#include <limits>

#include "log_line.h"
#include "palpate/core/error.h"
#include "sections.h"

namespace palpate::report {
namespace {

std::vector<double> numbers_at(const Json& object, const char* key) {
  std::vector<double> out;
  if (object.is_object() && object.contains(key) && object[key].is_array())
    for (const Json& value : object[key])
      out.push_back(value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN());
  return out;
}

/// Measurement over a refinement sequence.
struct Ladder {
  std::string quantity, size_label;
  std::vector<double> size, error, seconds;
};

std::vector<Ladder> ladders_of(const Json& one) {
  std::vector<Ladder> out;
  for (const Json& m : one["measurements"]) {
    if (!m.is_object() || !m.contains("refinement") || !m["refinement"].is_object()) continue;
    const Json& r = m["refinement"];
    Ladder ladder{text_at(m, "quantity"), text_at(r, "size_label"), numbers_at(r, "size"),
                  numbers_at(r, "error"), numbers_at(r, "wall_s")};
    if (ladder.size.size() >= 2 && ladder.size.size() == ladder.error.size())
      out.push_back(std::move(ladder));
  }
  return out;
}

constexpr const char* kErrorLabel = "error, relative unless the quantity states otherwise";

/// Plots errors over sizes of one kind, each with its fitted order.
Plot convergence_plot(const std::vector<Ladder>& ladders, const std::string& size_label) {
  Plot plot = log_log_plot(size_label, kErrorLabel);
  for (const Ladder& ladder : ladders) {
    if (ladder.size_label != size_label) continue;
    const double order = fit_log_line(ladder.size, ladder.error).slope;
    plot.series.push_back({.name = std::isfinite(order)
                                       ? fmt::format("{} (order {:.2f})", ladder.quantity, order)
                                       : ladder.quantity,
                           .x = ladder.size,
                           .y = ladder.error,
                           .mark = Mark::kLinePoints});
  }
  plot.height = 320 + 20 * static_cast<int>(plot.series.size());
  return plot;
}

Plot cost_plot(const std::vector<Ladder>& ladders) {
  Plot plot = log_log_plot("run time of the library [s]", kErrorLabel);
  for (const Ladder& ladder : ladders)
    if (ladder.seconds.size() == ladder.error.size())
      plot.series.push_back(
          {.name = ladder.quantity, .x = ladder.seconds, .y = ladder.error, .mark = Mark::kLinePoints});
  plot.height = 320 + 20 * static_cast<int>(plot.series.size());
  return plot;
}

void add_convergence(Page& page, const Json& cases) {
  bool any = false;
  for (const Json& one : cases) {
    if (!one.is_object() || !one.contains("measurements")) continue;
    const std::vector<Ladder> ladders = ladders_of(one);
    if (ladders.empty()) continue;
    if (!any) {
      page.add_heading("Convergence");
      page.begin_details("Error against size and run time, case by case");
    }
    any = true;
    std::vector<std::string> labels;
    for (const Ladder& ladder : ladders)
      if (std::find(labels.begin(), labels.end(), ladder.size_label) == labels.end())
        labels.push_back(ladder.size_label);
    for (const std::string& label : labels)
      add_plot(page, convergence_plot(ladders, label), "validation.json",
               fmt::format("{}: error against {}.", text_at(one, "name"), label));
    if (const Plot cost = cost_plot(ladders); !cost.series.empty())
      add_plot(page, cost, "validation.json", text_at(one, "name") + ": error against run time.");
  }
  if (any) page.end_details();
}

/// Table with one mark per row.
struct Marked {
  Rows rows;
  std::vector<RowMark> marks;
  void add(std::vector<std::string> row, bool good) {
    rows.push_back(std::move(row));
    marks.push_back(good ? RowMark::kGood : RowMark::kBad);
  }
};

const char* verdict(bool passed) { return passed ? "pass" : "FAIL"; }

/// Returns the largest ratio of an error of the case to its acceptance limit; NaN if no error has a limit.
double closest(const Json& measurements) {
  double out = std::numeric_limits<double>::quiet_NaN();
  for (const Json& m : measurements)
    if (const double share = number_at(m, "error") / number_at(m, "bar"); std::isfinite(share))
      out = std::isnan(out) ? share : std::max(out, share);
  return out;
}

void add_measurements(const Json& one, Marked& out) {
  for (const Json& m : one["measurements"]) {
    const bool passed = m.value("passed", false);
    out.add({text_at(one, "name"), text_at(m, "quantity"), short_number(number_at(m, "error")),
             short_number(number_at(m, "bar")), short_number(number_at(m, "computed"), 6),
             short_number(number_at(m, "exact"), 6),
             within_text(number_at(m, "order"), number_at(m, "order_low"), number_at(m, "order_high")),
             verdict(passed)},
            passed);
  }
}

void add_case(const Json& one, Marked& out) {
  const Json& measurements = one["measurements"];
  const auto passed = static_cast<std::size_t>(std::count_if(
      measurements.begin(), measurements.end(), [](const Json& m) { return m.value("passed", false); }));
  const bool good = passed == measurements.size() && !measurements.empty();
  std::string meaning = text_at(one, "summary");
  if (measurements.empty()) {
    const std::string broken = text_at(one, "broken");
    meaning += fmt::format(": {}", broken.empty() ? "nothing was measured" : broken);
  }
  const double share = closest(measurements);
  out.add({text_at(one, "name"), meaning, fmt::format("{} of {}", passed, measurements.size()),
           std::isfinite(share) ? fmt::format("{:.2g}", 100.0 * share) : "-",
           short_number(number_at(one, "wall_s")), verdict(good)},
          good);
}

}  // namespace

void add_validation(Page& page, const Json& validation) {
  const Json& cases =
      validation.is_object() && validation.contains("cases") ? validation["cases"] : validation;
  if (!cases.is_array()) return;
  Marked by_case, all;
  for (const Json& one : cases) {
    if (!one.is_object() || !one.contains("measurements")) continue;
    add_case(one, by_case);
    add_measurements(one, all);
  }
  page.add_heading("Validation against exact solutions");
  page.add_table({"case", "description", "measurements", "% of limit", "time [s]", "verdict"}, by_case.rows,
                 "% of limit: largest error of the case relative to its acceptance limit.", by_case.marks);
  Marked missed;
  for (std::size_t i = 0; i < all.rows.size(); ++i)
    if (all.marks[i] == RowMark::kBad) missed.add(all.rows[i], false);
  const std::vector<std::string> headers = {"case",     "quantity", "error", "bar",
                                            "computed", "exact",    "order", "verdict"};
  if (!missed.rows.empty()) {
    page.add_heading("Measurements outside their acceptance limit", 3);
    page.add_table(headers, missed.rows, "", missed.marks);
  }
  page.begin_details("All measurements");
  page.add_table(headers, all.rows, "Errors are relative unless the quantity states otherwise.", all.marks);
  page.end_details();
  add_convergence(page, cases);
}

}  // namespace palpate::report
