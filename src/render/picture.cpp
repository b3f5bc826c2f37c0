#include "render/picture.h"

#include <cairo.h>

#include <cmath>

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
  std::vector<std::uint32_t> words(picture.rgba.size() / 4);  // cairo's pixels: native words, 0xXXRRGGBB
  for (std::size_t i = 0; i < words.size(); ++i)
    words[i] = static_cast<std::uint32_t>(picture.rgba[4 * i]) << 16 |
               static_cast<std::uint32_t>(picture.rgba[4 * i + 1]) << 8 | picture.rgba[4 * i + 2];
  cairo_surface_t* surface =
      cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(words.data()), CAIRO_FORMAT_RGB24,
                                          picture.width, picture.height, 4 * picture.width);
  const cairo_status_t status = cairo_surface_write_to_png(surface, path.c_str());
  cairo_surface_destroy(surface);
  if (status != CAIRO_STATUS_SUCCESS)
    fail("{}: the picture cannot be written ({}); check that the folder exists, may be written, and has room",
         path.string(), cairo_status_to_string(status));
}

}  // namespace palpate::render
