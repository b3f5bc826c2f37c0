#include "palpate/render/field.h"

#include <algorithm>
#include <cmath>

#include "overlay.h"
#include "palpate/core/counters.h"
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
      canvas.set_colour(std::isfinite(value) ? viridis((value - scale.low) / (scale.high - scale.low))
                                             : kNoValue);
      canvas.fill_rectangle(left + column * magnify, top + (field.height - 1 - row) * magnify, magnify,
                            magnify);
    }
}

}  // namespace

Picture draw_field(const Field& field, const ColourScale& scale, const std::string& title, int magnify) {
  if (field.width < 1 || field.height < 1 ||
      field.values.size() != static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.height))
    fail("picture of a field: {} values for {} x {}", field.values.size(), field.width, field.height);
  counters::count("render.picture");
  double least = INFINITY, greatest = -INFINITY;
  for (const double v : field.values)
    if (std::isfinite(v)) least = std::min(least, v), greatest = std::max(greatest, v);
  const ColourScale shown = settled(scale, least, greatest);
  if (magnify < 1) magnify = std::max(1, 800 / std::max(field.width, field.height));

  const int left = 28, top = title.empty() ? 56 : 88, image_width = field.width * magnify,
            image_height = field.height * magnify;
  Canvas canvas(Picture(left + image_width + 150, top + image_height + 28, kPage));
  paint(canvas, field, shown, left, top, magnify);
  canvas.set_colour(kInk);
  canvas.text(title, left, 44, 22, 0.0, true);
  const ScaledUnit unit = scaled_unit(shown.unit, std::max(std::abs(shown.low), std::abs(shown.high)));
  canvas.text(unit.name.empty() ? shown.label : fmt::format("{} [{}]", shown.label, unit.name),
              left + image_width + 120, top - 18, kText, 1.0);
  draw_scale(canvas, shown, left + image_width + 28, top, 18, std::min(image_height, 420), kText);
  return canvas.result();
}

}  // namespace palpate::render
