#include "ticks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "palpate/core/error.h"

namespace palpate::render {

double round_up(double x) {
  PALPATE_CHECK(x > 0.0 && std::isfinite(x), "x = {}", x);
  const double decade = std::pow(10.0, std::floor(std::log10(x)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * decade >= x * (1.0 - 1e-9)) return digit * decade;
  return 10.0 * decade;
}

ScaledUnit scaled_unit(const std::string& unit, double largest) {
  static const std::array<std::string, 8> prefixable = {"m", "m/s", "Pa", "N", "J", "N m", "s", "W"};
  static const std::array<std::pair<double, const char*>, 6> prefixes = {
      {{1e9, "n"}, {1e6, "µ"}, {1e3, "m"}, {1.0, ""}, {1e-3, "k"}, {1e-6, "M"}}};
  if (!(largest > 0.0) || !std::isfinite(largest) ||
      std::find(prefixable.begin(), prefixable.end(), unit) == prefixable.end())
    return {1.0, unit};
  for (const auto& [factor, prefix] : prefixes)
    if (largest * factor < 1000.0) return {factor, prefix + unit};
  return {1e-9, "G" + unit};
}

std::vector<Tick> ticks(double low, double high, const ScaledUnit& unit) {
  PALPATE_CHECK(high > low, "low = {}, high = {}", low, high);
  const double first = low * unit.factor, last = high * unit.factor;
  const double step = round_up((last - first) / 6.0), slack = 1e-9 * (last - first);
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 12);
  std::vector<Tick> out;
  for (double k = std::ceil((first - slack) / step); k * step <= last + slack; k += 1.0) {
    const double value = k == 0.0 ? 0.0 : k * step;  // Avoids "-0".
    const bool plain = std::abs(last) < 1e5 && decimals <= 6;
    out.push_back({value / unit.factor,
                   plain ? fmt::format("{:.{}f}", value, decimals) : fmt::format("{:.3g}", value)});
  }
  return out;
}

}  // namespace palpate::render
