#include "render/colour_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/object_colours.h"
#include "palpate/core/error.h"

namespace palpate::render {
namespace {

int hex_digit(char c) {
  const int value = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
  PALPATE_CHECK(value >= 0, "\"{}\" is no hexadecimal digit", c);
  return value;
}

}  // namespace

Rgb colour_of(std::string_view hex) {
  PALPATE_CHECK(hex.size() == 7 && hex[0] == '#', "\"{}\" is no colour", hex);
  const auto channel = [&](std::size_t at) {
    return static_cast<float>(16 * hex_digit(hex[at]) + hex_digit(hex[at + 1])) / 255.0f;
  };
  return {channel(1), channel(3), channel(5)};
}

Rgb ramp(double t) {
  static const auto stops = [] {
    std::array<Rgb, colours::kRamp.size()> out{};
    std::transform(colours::kRamp.begin(), colours::kRamp.end(), out.begin(), colour_of);
    return out;
  }();
  const double at = std::clamp(t, 0.0, 1.0) * (stops.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const auto share = static_cast<float>(at - static_cast<double>(i));
  const auto between = [share](float a, float b) { return a + share * (b - a); };
  const Rgb &a = stops[i], &b = stops[i + 1];
  return {between(a.r, b.r), between(a.g, b.g), between(a.b, b.b)};
}

ColourScale settled(const ColourScale& scale, double least, double greatest) {
  ColourScale out = scale;
  if (std::isnan(out.low)) out.low = least;
  if (std::isnan(out.high)) out.high = greatest;
  if (!std::isfinite(out.low)) out.low = 0.0;
  if (!(out.high - out.low > scale.resolution) || !std::isfinite(out.high)) out.high = out.low;
  if (out.is_flat() && std::abs(out.low) <= scale.resolution) out.low = out.high = 0.0;
  return out;
}

double share(const ColourScale& scale, double value) {
  return scale.is_flat() ? 0.0 : std::clamp((value - scale.low) / (scale.high - scale.low), 0.0, 1.0);
}

}  // namespace palpate::render
