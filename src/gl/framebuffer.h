#pragma once
#include <cstdint>
#include <vector>

namespace palpate::gl {

/// Pixel format of a texture.
enum class Format { kRgba8, kR32ui, kR32f, kRgba32f, kDepth32f };

/// 2-D texture with one level and nearest sampling.  Pixel (0, 0) is at the lower left.
class Texture {
 public:
  /// Allocates a texture.  @throws Error where the device does not support the size [pixels]
  Texture(int width, int height, Format format);
  ~Texture();
  Texture(Texture&& other) noexcept;
  Texture& operator=(Texture&& other) noexcept;

  unsigned id() const { return id_; }
  int width() const { return width_; }
  int height() const { return height_; }
  Format format() const { return format_; }
  void bind_unit(unsigned unit) const;  ///< Binds to a sampler unit.
  void upload(const void* pixels);      ///< Uploads all pixels, rows from bottom to top, no padding.
  void set_linear(bool linear);         ///< Linear filtering of floats and colours.

 private:
  Texture() = default;
  unsigned id_ = 0;
  int width_ = 0, height_ = 0;
  Format format_ = Format::kRgba8;
};

enum class DepthBuffer { kNone, kDepth };

/// Render target: colour textures and an optional depth texture.
class Framebuffer {
 public:
  /// @param colours  formats of the colour attachments, in order
  Framebuffer(int width, int height, const std::vector<Format>& colours, DepthBuffer depth);
  ~Framebuffer();
  Framebuffer(Framebuffer&& other) noexcept;
  Framebuffer& operator=(Framebuffer&& other) noexcept;

  /// Makes it the draw target, with a viewport of its full size.
  void bind() const;
  void clear(int attachment, const float rgba[4]);
  void clear(int attachment, std::uint32_t value);
  void clear_depth(float depth);

  int width() const { return width_; }
  int height() const { return height_; }
  const Texture& colour(int attachment) const { return colours_.at(static_cast<std::size_t>(attachment)); }
  const Texture& depth() const;  ///< Precondition: made with depth.

  /// Reads the pixels of one attachment, rows from bottom to top.
  std::vector<std::uint8_t> read_rgba8(int attachment = 0) const;  ///< 4 bytes per pixel.
  std::vector<std::uint32_t> read_r32ui(int attachment = 0) const;
  std::vector<float> read_float(int attachment = 0) const;  ///< kR32f: 1 per pixel, kRgba32f: 4.
  std::vector<float> read_depth() const;

 private:
  void read_pixels(int attachment, unsigned format, unsigned type, void* out) const;
  unsigned id_ = 0;
  int width_ = 0, height_ = 0;
  std::vector<Texture> colours_;
  std::vector<Texture> depth_;  // None or one.
};

}  // namespace palpate::gl
