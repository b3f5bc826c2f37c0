#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace palpate::render {

/// Colour in sRGB encoding, each channel in [0, 1].
struct Rgb {
  float r = 0.0f, g = 0.0f, b = 0.0f;
};

/// Opaque image, rows from top to bottom, 4 bytes per pixel (R, G, B, 255).
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;

  Picture() = default;
  /// Makes a picture of one colour.  @pre w > 0, h > 0
  Picture(int w, int h, Rgb fill);
  /// Returns the four bytes of a pixel; y counts from the top.
  const std::uint8_t* pixel(int x, int y) const {
    return &rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x))];
  }
  std::uint8_t* pixel(int x, int y) {
    return const_cast<std::uint8_t*>(static_cast<const Picture&>(*this).pixel(x, y));
  }
};

/// Writes a PNG file.  Equal pictures give equal bytes.
/// @throws Error with the path when it cannot be written
void save_png(const Picture& picture, const std::filesystem::path& path);

}  // namespace palpate::render
