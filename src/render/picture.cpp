#include "render/picture.h"

#include <cmath>

#include "canvas.h"
#include "palpate/core/error.h"

namespace palpate::render {

Picture::Picture(int w, int h, Rgb fill) : width(w), height(h) {
  PALPATE_CHECK(w > 0 && h > 0, "a picture of {} x {} pixels", w, h);
  const auto byte = [](float channel) { return static_cast<std::uint8_t>(std::lround(255.0f * channel)); };
  const std::uint8_t colour[4] = {byte(fill.r), byte(fill.g), byte(fill.b), 255};
  rgba.resize(4 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
  for (std::size_t i = 0; i < rgba.size(); ++i) rgba[i] = colour[i % 4];
}

void save_png(const Picture& picture, const std::filesystem::path& path) {
  Canvas canvas(picture);
  const cairo_status_t status = cairo_surface_write_to_png(canvas.surface(), path.c_str());
  if (status != CAIRO_STATUS_SUCCESS)
    fail("{}: the picture cannot be written ({}); check that the folder exists, may be written, and has room",
         path.string(), cairo_status_to_string(status));
}

}  // namespace palpate::render
