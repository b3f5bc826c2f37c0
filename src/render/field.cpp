#include "render/field.h"

#include <algorithm>
#include <cmath>

#include "core/counters.h"
#include "overlay.h"
#include "palpate/core/error.h"
#include "ticks.h"

namespace palpate::render {
namespace {

constexpr Rgb kPage = {1.0f, 1.0f, 1.0f}, kNoValue = {0.93f, 0.94f, 0.95f}, kInk = {0.13f, 0.16f, 0.19f};
constexpr double kText = 16.0;

void paint(Canvas& canvas, const Field& field, const ColourScale& scale, int left, int top, int magnify) {
  for (int row = 0; row < field.height; ++row)
    for (int column = 0; column < field.width; ++column) {
      const double value =
          field.values[static_cast<std::size_t>(row) * static_cast<std::size_t>(field.width) +
                       static_cast<std::size_t>(column)];
      canvas.set_colour(std::isfinite(value) ? ramp(share(scale, value)) : kNoValue);
      canvas.fill_rectangle(left + column * magnify, top + (field.height - 1 - row) * magnify, magnify,
                            magnify);
    }
}

/// Draws a length scale: a bar of a round length, about a quarter of the field's width, with its label.
void draw_length(Canvas& canvas, double metres_per_pixel, double left, double baseline, double width) {
  double length = round_up(0.125 * width * metres_per_pixel);
  if (length / metres_per_pixel > 0.5 * width) length = 0.5 * width * metres_per_pixel;
  const ScaledUnit unit = scaled_unit("m", length);
  const double pixels = length / metres_per_pixel;
  canvas.set_colour(kInk);
  canvas.fill_rectangle(left, baseline - 7, pixels, 3);
  for (const double end : {left, left + pixels - 1.5}) canvas.fill_rectangle(end, baseline - 11, 1.5, 11);
  canvas.text(fmt::format("{:.3g} {}", length * unit.factor, unit.name), left + pixels + 10, baseline, kText);
}

}  // namespace

Picture draw_field(const Field& field, const ColourScale& scale, const std::string& title, int magnify,
                   const std::string& subtitle) {
  if (field.width < 1 || field.height < 1 ||
      field.values.size() != static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.height))
    fail("picture of a field: {} values for {} x {}", field.values.size(), field.width, field.height);
  counters::count("render.picture");
  double least = INFINITY, greatest = -INFINITY;
  for (const double v : field.values)
    if (std::isfinite(v)) least = std::min(least, v), greatest = std::max(greatest, v);
  const ColourScale shown = settled(scale, least, greatest);
  if (magnify < 1) magnify = std::max(1, 800 / std::max(field.width, field.height));

  const int left = 28, image_width = field.width * magnify, image_height = field.height * magnify,
            top = (title.empty() ? 56 : 88) + (subtitle.empty() ? 0 : 28),
            bottom = field.cell > 0.0 ? 52 : 28;
  Canvas measure(Picture(1, 1, kPage));
  const int width =
      std::max({left + image_width + 150, left + 28 + static_cast<int>(measure.text_width(title, 22, true)),
                left + 28 + static_cast<int>(measure.text_width(subtitle, kText))});
  Canvas canvas(Picture(width, top + image_height + bottom, kPage));
  paint(canvas, field, shown, left, top, magnify);
  canvas.set_colour(kInk);
  canvas.text(title, left, 44, 22, 0.0, true);
  canvas.text(subtitle, left, title.empty() ? 36 : 72, kText);
  const ScaledUnit unit = scaled_unit(shown.unit, std::max(std::abs(shown.low), std::abs(shown.high)));
  canvas.text(unit.name.empty() ? shown.label : fmt::format("{} [{}]", shown.label, unit.name),
              left + image_width + 120, top - 18, kText, 1.0);
  draw_scale(canvas, shown, left + image_width + 28, top, 18, std::min(image_height, 420), kText);
  if (field.cell > 0.0)
    draw_length(canvas, field.cell / magnify, left, top + image_height + bottom - 16, image_width);
  return canvas.result();
}

}  // namespace palpate::render
