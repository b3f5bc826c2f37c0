#include "average.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "palpate/core/error.h"

namespace palpate::render {
namespace {

/// IEC 61966-2-1, and its inverse.
double to_linear(double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); }
double to_screen(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055; }

// Size of the inverse's table: error less than half a screen step everywhere, zero included.
constexpr int kSteps = 8192;

struct Tables {
  std::array<float, 256> linear{};
  std::array<std::uint8_t, kSteps + 1> screen{};
  Tables() {
    for (int i = 0; i < 256; ++i)
      linear[static_cast<std::size_t>(i)] = static_cast<float>(to_linear(i / 255.0));
    for (int i = 0; i <= kSteps; ++i)
      screen[static_cast<std::size_t>(i)] =
          static_cast<std::uint8_t>(std::lround(255.0 * to_screen(double(i) / kSteps)));
  }
};

}  // namespace

Picture average(const std::vector<std::uint8_t>& rgba, int width, int height, int samples) {
  static const Tables tables;
  const auto row = static_cast<std::size_t>(width * samples) * 4;
  PALPATE_CHECK(rgba.size() == row * static_cast<std::size_t>(height * samples),
                "{} bytes for {} x {} x {}^2", rgba.size(), width, height, samples);
  Picture out(width, height, {});
  const float scale = static_cast<float>(kSteps) / static_cast<float>(samples * samples);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (std::size_t channel = 0; channel < 3; ++channel) {
        float sum = 0.0f;
        for (int j = 0; j < samples; ++j) {
          const std::uint8_t* p = &rgba[static_cast<std::size_t>((height - 1 - y) * samples + j) * row +
                                        static_cast<std::size_t>(x * samples) * 4 + channel];
          for (int i = 0; i < samples; ++i) sum += tables.linear[p[4 * i]];
        }
        out.pixel(x, y)[channel] = tables.screen[static_cast<std::size_t>(
            std::clamp(std::lround(sum * scale), 0L, static_cast<long>(kSteps)))];
      }
  return out;
}

}  // namespace palpate::render
