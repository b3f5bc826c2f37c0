#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"
#include "report/clock.h"
#include "sections.h"

namespace palpate::report {
namespace {

constexpr int kPerDecade = 10;
constexpr double kEmpty = 0.5;  // height of an empty bin: a logarithmic axis has no zero

int bin_of(double value) {
  return static_cast<int>(std::floor(kPerDecade * std::log10(std::max(value, kLeastBin)) + 1e-9));
}

double edge(int bin) { return std::pow(10.0, static_cast<double>(bin) / kPerDecade); }

/// Returns the quantile q by the nearest-rank method.
double nearest_rank(const std::vector<double>& sorted, double q) {
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(q * static_cast<double>(sorted.size()))) - 1;
  return sorted[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(rank, 0, std::ssize(sorted) - 1))];
}

std::string duration_text(double us) {
  return us < 1e3   ? fmt::format("{:.3g} µs", us)
         : us < 1e6 ? fmt::format("{:.3g} ms", 1e-3 * us)
                    : fmt::format("{:.3g} s", 1e-6 * us);
}

}  // namespace

LogHistogram log_histogram(const std::vector<double>& values) {
  PALPATE_CHECK(!values.empty(), "a histogram needs at least one value");
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  const int first = bin_of(*least), last = bin_of(*greatest);
  LogHistogram out;
  out.counts.resize(static_cast<std::size_t>(last - first + 1), 0);
  for (const double value : values) ++out.counts[static_cast<std::size_t>(bin_of(value) - first)];
  for (int bin = first; bin <= last + 1; ++bin) out.edges.push_back(edge(bin));
  return out;
}

Plot tick_histogram(const std::vector<double>& values_us, const std::string& x_label) {
  const LogHistogram histogram = log_histogram(values_us);
  Plot plot = log_log_plot(x_label + " [µs]", "number of ticks");
  plot.height = 320;
  Series bars{.name = "", .x = {histogram.edges.front()}, .y = {kEmpty}, .mark = Mark::kArea};
  for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
    const double height = std::max(kEmpty, static_cast<double>(histogram.counts[i]));
    bars.x.insert(bars.x.end(), {histogram.edges[i], histogram.edges[i + 1]});
    bars.y.insert(bars.y.end(), {height, height});
  }
  bars.x.push_back(histogram.edges.back());
  bars.y.push_back(kEmpty);
  const double highest = *std::max_element(bars.y.begin(), bars.y.end());
  plot.series.push_back(std::move(bars));
  std::vector<double> sorted = values_us;
  std::sort(sorted.begin(), sorted.end());
  for (const auto& [name, q] : {std::pair{"p50", 0.5}, {"p99", 0.99}, {"p99.9", 0.999}, {"max", 1.0}}) {
    const double value = nearest_rank(sorted, q), at = std::max(value, kLeastBin);
    plot.series.push_back({.name = fmt::format("{} {}", name, duration_text(value)),
                           .x = {at, at},
                           .y = {kEmpty, highest},
                           .mark = Mark::kDashed});
  }
  return plot;
}

void add_clock(Page& page, const Table& clock) {
  const auto finite = [&](const char* column) {
    std::vector<double> out = clock.numbers(column);
    std::erase_if(out, [](double value) { return !std::isfinite(value); });
    return out;
  };
  const std::vector<double> late = finite("late_us"), work = finite("work_us");
  if (late.empty() || work.empty()) return;
  page.add_heading("Ticks in real time");
  add_plot(page, tick_histogram(late, "tick lateness"), "clock.csv",
           fmt::format("Lateness of {} ticks: start after the due time. Lines mark the median, the 99 % and "
                       "99.9 % quantiles, and the maximum.",
                       late.size()));
  add_plot(page, tick_histogram(work, "tick work"), "clock.csv",
           "Time of each tick from its start to the wrench on the device.");
}

}  // namespace palpate::report
