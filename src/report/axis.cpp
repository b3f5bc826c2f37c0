#include "axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate::report {
namespace {

/// Returns the label of a tick: 0.01, 5, 200 within four decades of one; otherwise 2x10^-7 in the enhanced
/// text of gnuplot.
std::string tick_label(double value, int exponent, int digit, bool plain) {
  if (plain) return fmt::format("{:g}", value);
  return digit == 1 ? fmt::format("10^{{{}}}", exponent) : fmt::format("{}·10^{{{}}}", digit, exponent);
}

std::vector<std::pair<double, std::string>> logarithmic_ticks(double low, double high) {
  const double decades = std::log10(high / low);
  const int first = static_cast<int>(std::floor(std::log10(low))),
            last = static_cast<int>(std::ceil(std::log10(high)));
  const bool plain = first >= -4 && last <= 4;
  const int stride = std::max(1, static_cast<int>(std::ceil(decades / 9.0)));
  std::vector<std::pair<double, std::string>> ticks;
  for (int e = first; e <= last; ++e) {
    for (const int digit : {1, 2, 5}) {
      if (digit != 1 && decades > 2.2) continue;
      if (digit == 1 && decades > 2.2 && e % stride != 0) continue;
      const double value = digit * std::pow(10.0, e);
      if (value >= low * 0.999 && value <= high * 1.001)
        ticks.emplace_back(value, tick_label(value, e, digit, plain));
    }
  }
  return ticks;
}

}  // namespace

Axis make_axis(const std::vector<double>& values, bool logarithmic, double margin_low, double margin_high) {
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  Axis axis{*least, *greatest, logarithmic};
  if (logarithmic) {
    // The margins are fractions of at least 0.6 decades, so that a single value, or close values, get a range
    // too.
    const double decades = std::max(std::log10(axis.high / axis.low), 0.6);
    axis.low /= std::pow(10.0, margin_low * decades);
    axis.high *= std::pow(10.0, margin_high * decades);
    axis.ticks = logarithmic_ticks(axis.low, axis.high);
    return axis;
  }
  // A constant curve is centred in a range of twice its magnitude.
  const double span = axis.high > axis.low ? axis.high - axis.low : std::max(1e-9, 2.0 * std::abs(axis.high));
  const double widen = axis.high > axis.low ? 0.0 : 0.5 * span;
  axis.low -= widen + margin_low * span;
  axis.high += widen + margin_high * span;
  return axis;
}

std::string axis_commands(const std::string& name, const Axis& axis) {
  std::string out;
  if (axis.logarithmic) out += fmt::format("set logscale {}\nset m{}tics 10\n", name, name);
  out += fmt::format("set {}range [{:.9g}:{:.9g}]\n", name, axis.low, axis.high);
  if (axis.ticks.empty()) return out;
  out += fmt::format("set {}tics (", name);
  for (std::size_t i = 0; i < axis.ticks.size(); ++i)
    out += fmt::format("{}'{}' {:.9g}", i > 0 ? ", " : "", axis.ticks[i].second, axis.ticks[i].first);
  return out + ")\n";
}

}  // namespace palpate::report
