#pragma once
#include <cairo.h>

#include <string>

#include "render/picture.h"

namespace palpate::render {

/// Drawing surface by cairo on a copy of a picture; result() returns the copy.  Lengths are in pixels, y
/// downwards.
class Canvas {
 public:
  explicit Canvas(const Picture& picture);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  cairo_t* pen() const { return pen_; }
  Picture result() const;

  void set_colour(Rgb colour, double opacity = 1.0);
  void fill_rectangle(double x, double y, double width, double height);
  /// Draws text with its baseline at y; `anchor` 0: begins at x, 1: ends at x.
  void text(const std::string& text, double x, double y, double size, double anchor = 0.0, bool bold = false);
  double text_width(const std::string& text, double size, bool bold = false);

 private:
  void choose_font(double size, bool bold);
  cairo_surface_t* surface_ = nullptr;
  cairo_t* pen_ = nullptr;
};

}  // namespace palpate::render
