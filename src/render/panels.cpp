#include "render/panels.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "canvas.h"
#include "palpate/core/error.h"
#include "ticks.h"

namespace palpate::render {
namespace {

constexpr Rgb kPanel = {0.968f, 0.973f, 0.980f}, kPanelInk = {0.13f, 0.16f, 0.19f},
              kPanelQuiet = {0.62f, 0.66f, 0.70f}, kLine = {0.15f, 0.35f, 0.60f},
              kMark = {0.80f, 0.33f, 0.10f};

void copy_into(Picture& to, const Picture& from, int left, int top) {
  for (int y = 0; y < from.height; ++y)
    std::memcpy(to.pixel(left, top + y), from.pixel(0, y), 4 * static_cast<std::size_t>(from.width));
}

/// Axes of a plot: maps time and value to pixels.
struct Axes {
  double left, top, width, height;  ///< Plot area [pixels].
  double t0, t1, low, high;
  double x(double t) const { return left + width * (t - t0) / (t1 - t0); }
  double y(double v) const { return top + height * (high - v) / (high - low); }
};

void draw_axes(Canvas& canvas, const Axes& axes, const Curve& curve, double text) {
  const ScaledUnit unit = scaled_unit(curve.unit, std::max(std::abs(axes.low), std::abs(axes.high)));
  const ScaledUnit seconds = scaled_unit("s", axes.t1);
  const double step = round_up((axes.high - axes.low) / 3.0);
  for (double k = std::ceil(axes.low / step - 1e-9); k * step <= axes.high * (1.0 + 1e-9); k += 1.0) {
    canvas.set_colour(kPanelQuiet, 0.5);
    canvas.fill_rectangle(axes.left, axes.y(k * step) - 0.5, axes.width, 1.0);
    canvas.set_colour(kPanelInk);  // Adding 0 avoids "-0".
    canvas.text(fmt::format("{:g}", k * step * unit.factor + 0.0), axes.left - 8,
                axes.y(k * step) + 0.36 * text, text, 1.0);
  }
  for (const Tick& tick : ticks(axes.t0, axes.t1, seconds)) {
    canvas.set_colour(kPanelInk);
    const double half = 0.5 * canvas.text_width(tick.text, text);
    canvas.text(tick.text, axes.x(tick.value) - half, axes.top + axes.height + 1.3 * text, text);
  }
  canvas.set_colour(kPanelInk);
  canvas.text(fmt::format("{} [{}]", curve.label, unit.name), axes.left, axes.top - 0.6 * text, text);
  canvas.text(fmt::format("[{}]", seconds.name), axes.left + axes.width + 1.2 * text,
              axes.top + axes.height + 1.3 * text, text);
}

}  // namespace

Picture beside(const std::vector<Picture>& pictures) {
  PALPATE_CHECK(!pictures.empty(), "no pictures");
  int width = 0;
  for (const Picture& picture : pictures) {
    PALPATE_CHECK(picture.height == pictures[0].height, "pictures {} and {} pixels high", picture.height,
                  pictures[0].height);
    width += picture.width;
  }
  Picture out(width, pictures[0].height, {});
  int left = 0;
  for (const Picture& picture : pictures) {
    copy_into(out, picture, left, 0);
    left += picture.width;
  }
  return out;
}

Picture with_curve(const Picture& picture, const Curve& curve, double now, int height) {
  PALPATE_CHECK(!curve.times.empty() && curve.times.size() == curve.values.size(),
                "a curve of {} times, {} values", curve.times.size(), curve.values.size());
  Picture page(picture.width, picture.height + height, kPanel);
  copy_into(page, picture, 0, 0);
  Canvas canvas(page);
  const double text = 0.11 * height;
  Axes axes{.left = 6.0 * text,
            .top = picture.height + 2.0 * text,
            .width = picture.width - 11.0 * text,
            .height = height - 4.4 * text,
            .t0 = curve.times.front(),
            .t1 = curve.times.back(),
            .low = 0.0,
            .high = 0.0};
  for (const double v : curve.values) axes.low = std::min(axes.low, v), axes.high = std::max(axes.high, v);
  if (!(axes.high > axes.low)) axes.high = axes.low + 1.0;  // All values are zero: any range will do.
  if (!(axes.t1 > axes.t0)) axes.t1 = axes.t0 + 1.0;
  draw_axes(canvas, axes, curve, text);
  cairo_t* pen = canvas.pen();
  canvas.set_colour(kLine);
  cairo_set_line_width(pen, 0.016 * height);
  cairo_set_line_join(pen, CAIRO_LINE_JOIN_ROUND);
  cairo_new_path(pen);
  for (std::size_t i = 0; i < curve.times.size(); ++i)
    cairo_line_to(pen, axes.x(curve.times[i]), axes.y(curve.values[i]));
  cairo_stroke(pen);
  canvas.set_colour(kMark);
  canvas.fill_rectangle(axes.x(std::clamp(now, axes.t0, axes.t1)) - 1.0, axes.top, 2.0, axes.height);
  return canvas.result();
}

}  // namespace palpate::render
