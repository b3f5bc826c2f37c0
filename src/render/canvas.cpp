#include "canvas.h"

#include <cstring>

#include "palpate/core/error.h"

namespace palpate::render {

// cairo stores a pixel as one native 32-bit word, 0xXXRRGGBB.
Canvas::Canvas(const Picture& picture)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, picture.width, picture.height)) {
  PALPATE_CHECK(cairo_surface_status(surface_) == CAIRO_STATUS_SUCCESS, "cairo: {}",
                cairo_status_to_string(cairo_surface_status(surface_)));
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface_));
  unsigned char* data = cairo_image_surface_get_data(surface_);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const std::uint8_t* p = picture.pixel(x, y);
      const std::uint32_t word =
          static_cast<std::uint32_t>(p[0]) << 16 | static_cast<std::uint32_t>(p[1]) << 8 | p[2];
      std::memcpy(data + static_cast<std::size_t>(y) * stride + 4 * static_cast<std::size_t>(x), &word, 4);
    }
  cairo_surface_mark_dirty(surface_);
  pen_ = cairo_create(surface_);
  // Glyphs must be equal on every machine: grey antialiasing, no hinting to a screen's pixels.
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(pen_, options);
  cairo_font_options_destroy(options);
}

Canvas::~Canvas() {
  cairo_destroy(pen_);
  cairo_surface_destroy(surface_);
}

Picture Canvas::result() const {
  cairo_surface_flush(surface_);
  Picture picture(cairo_image_surface_get_width(surface_), cairo_image_surface_get_height(surface_), {});
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface_));
  const unsigned char* data = cairo_image_surface_get_data(surface_);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      std::uint32_t word = 0;
      std::memcpy(&word, data + static_cast<std::size_t>(y) * stride + 4 * static_cast<std::size_t>(x), 4);
      std::uint8_t* p = picture.pixel(x, y);
      p[0] = static_cast<std::uint8_t>(word >> 16), p[1] = static_cast<std::uint8_t>(word >> 8),
      p[2] = static_cast<std::uint8_t>(word);
    }
  return picture;
}

void Canvas::set_colour(Rgb colour, double opacity) {
  cairo_set_source_rgba(pen_, colour.r, colour.g, colour.b, opacity);
}

void Canvas::fill_rectangle(double x, double y, double width, double height) {
  cairo_rectangle(pen_, x, y, width, height);
  cairo_fill(pen_);
}

void Canvas::choose_font(double size, bool bold) {
  cairo_select_font_face(pen_, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(pen_, size);
}

double Canvas::text_width(const std::string& text, double size, bool bold) {
  choose_font(size, bold);
  cairo_text_extents_t extents;
  cairo_text_extents(pen_, text.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::text(const std::string& text, double x, double y, double size, double anchor, bool bold) {
  const double width = anchor == 0.0 ? 0.0 : text_width(text, size, bold);
  choose_font(size, bold);
  cairo_move_to(pen_, x - anchor * width, y);
  cairo_show_text(pen_, text.c_str());
}

}  // namespace palpate::render
