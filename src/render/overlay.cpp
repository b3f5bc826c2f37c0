#include "overlay.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "palpate/core/error.h"
#include "ticks.h"

namespace palpate::render {
namespace {

constexpr Rgb kInk = {0.13f, 0.16f, 0.19f}, kQuiet = {0.38f, 0.42f, 0.46f}, kPlate = {0.968f, 0.973f, 0.980f};
constexpr double kDesignHeight = 900.0;  // Lengths below are pixels of a picture of this height.

/// From the colour bar to the image's edge; padding of a plate.
constexpr double kScaleEdge = 32.0, kPlateEdge = 8.0;

/// Returns the label with its unit: "displacement [mm]".
std::string label_of(const ColourScale& scale) {
  const ScaledUnit unit = scaled_unit(scale.unit, std::max(std::abs(scale.low), std::abs(scale.high)));
  return unit.name.empty() ? scale.label : fmt::format("{} [{}]", scale.label, unit.name);
}

/// Returns the width of the colour bar with label and ticks [pixels].
double width_of_scale(Canvas& canvas, const ColourScale& scale, double u) {
  return std::max(
      {canvas.text_width(label_of(scale), 18 * u), canvas.text_width(scale.note, 15 * u), 110 * u});
}

/// Draws a pale plate that keeps a text legible where the scene extends under it, which happens when only a
/// part is framed.  On the background of a whole scene it is invisible.
void draw_plate(Canvas& canvas, double x, double y, double width, double height, double u) {
  canvas.set_colour(kPlate, 0.8);
  canvas.fill_rectangle(x - kPlateEdge * u, y - 4 * u, width + 2 * kPlateEdge * u, height + 8 * u);
}

void draw_names(Canvas& canvas, const Scene& scene, double grid_spacing, double u, double height) {
  double x = 36 * u;
  const double baseline = height - 34 * u, size = 17 * u;
  for (const Surface& surface : scene.surfaces) {
    if (surface.name.empty() || surface.values.size() > 0) continue;
    draw_plate(canvas, x, baseline - 15 * u, 23 * u + canvas.text_width(surface.name, size), 20 * u, u);
    // Faint colours would not be recognisable.
    canvas.set_colour(surface.colour, std::max(surface.opacity, 0.4));
    canvas.fill_rectangle(x, baseline - 13 * u, 15 * u, 15 * u);
    canvas.set_colour(kInk);
    canvas.text(surface.name, x + 23 * u, baseline, size);
    x += 23 * u + canvas.text_width(surface.name, size) + 28 * u;
  }
  if (grid_spacing > 0.0) {
    const ScaledUnit unit = scaled_unit("m", grid_spacing);
    canvas.set_colour(kQuiet);
    canvas.text(fmt::format("grid {:g} {}", grid_spacing * unit.factor, unit.name), x, baseline, size);
  }
}

}  // namespace

Margins margins_of(const Scene& scene, const Options& options, const std::optional<ColourScale>& scale) {
  Margins margins;
  if (!options.annotated) return margins;
  if (!scene.title.empty()) margins.top = 0.125;
  margins.bottom = 0.10;
  if (scale) {
    Canvas canvas(Picture(16, 16, kPlate));
    const double u = options.height / kDesignHeight,
                 needed = width_of_scale(canvas, *scale, u) + (kScaleEdge + 2.0 * kPlateEdge) * u;
    margins.right = std::min(0.35, needed / options.width);
  }
  return margins;
}

void draw_scale(Canvas& canvas, const ColourScale& scale, double x, double y, double width, double height,
                double text_size) {
  const ScaledUnit unit = scaled_unit(scale.unit, std::max(std::abs(scale.low), std::abs(scale.high)));
  const int rows = std::max(2, static_cast<int>(height));
  for (int i = 0; i < rows; ++i) {
    canvas.set_colour(ramp(scale.is_flat() ? 0.0 : 1.0 - (i + 0.5) / rows));
    canvas.fill_rectangle(x, y + i * height / rows, width, height / rows + (i + 1 < rows ? 0.6 : 0.0));
  }
  const std::vector<Tick> marks =
      scale.is_flat() ? std::vector<Tick>{{scale.low, fmt::format("{:.4g}", scale.low * unit.factor)}}
                      : ticks(scale.low, scale.high, unit);
  for (const Tick& tick : marks) {
    const double at = y + height * (1.0 - share(scale, tick.value));
    canvas.set_colour(kInk);
    canvas.fill_rectangle(x + width, at - 0.5, 0.35 * text_size, 1.0);
    canvas.text(tick.text, x + width + 0.6 * text_size, at + 0.36 * text_size, text_size);
  }
}

Picture annotated(const Picture& picture, const Scene& scene, const ColourScale& scale, bool with_scale,
                  double grid_spacing) {
  Canvas canvas(picture);
  const double u = picture.height / kDesignHeight, width = picture.width, height = picture.height;
  const double subtitle_y = (scene.title.empty() ? 52 : 88) * u;
  if (!scene.title.empty())
    draw_plate(canvas, 36 * u, 34 * u, canvas.text_width(scene.title, 29 * u, true), 30 * u, u);
  if (!scene.subtitle.empty())
    draw_plate(canvas, 36 * u, subtitle_y - 16 * u, canvas.text_width(scene.subtitle, 18 * u), 22 * u, u);
  canvas.set_colour(kInk);
  canvas.text(scene.title, 36 * u, 58 * u, 29 * u, 0.0, true);
  canvas.set_colour(kQuiet);
  canvas.text(scene.subtitle, 36 * u, subtitle_y, 18 * u);
  if (with_scale) {
    const double bar_height = 0.46 * height, bar_x = width - 108 * u, bar_y = 0.5 * (height - bar_height);
    const double right = width - kScaleEdge * u, own = width_of_scale(canvas, scale, u);
    draw_plate(canvas, right - own, bar_y - 38 * u, own, bar_height + (scale.note.empty() ? 52 : 76) * u, u);
    canvas.set_colour(kInk);
    canvas.text(label_of(scale), right, bar_y - 20 * u, 18 * u, 1.0);
    draw_scale(canvas, scale, bar_x, bar_y, 20 * u, bar_height, 17 * u);
    canvas.set_colour(kQuiet);
    canvas.text(scale.note, right, bar_y + bar_height + 32 * u, 15 * u, 1.0);
  }
  draw_names(canvas, scene, grid_spacing, u, height);
  return canvas.result();
}

}  // namespace palpate::render
