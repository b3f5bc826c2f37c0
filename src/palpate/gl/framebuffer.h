#pragma once
#include <cstdint>
#include <vector>

namespace palpate::gl {

enum class Format { kRgba8, kR32ui, kR32f, kRgba32f, kDepth32f };

/// A 2-D texture with one level and nearest sampling.  Pixel (0, 0) is the lower left one.
class Texture {
 public:
  Texture(int width, int height, Format format);
  ~Texture();
  Texture(Texture&& other) noexcept;
  Texture& operator=(Texture&& other) noexcept;

  unsigned id() const { return id_; }
  int width() const { return width_; }
  int height() const { return height_; }
  Format format() const { return format_; }
  void bind_unit(unsigned unit) const;  ///< for a sampler
  void upload(const void* pixels);      ///< all of it, rows from below, no padding
  void set_linear(bool linear);         ///< linear filtering of floats and colours

 private:
  Texture() = default;
  unsigned id_ = 0;
  int width_ = 0, height_ = 0;
  Format format_ = Format::kRgba8;
};

enum class DepthBuffer { kNone, kDepth };

/// Colour textures and, when asked, a depth texture to draw into.
class Framebuffer {
 public:
  Framebuffer(int width, int height, const std::vector<Format>& colours, DepthBuffer depth);
  ~Framebuffer();
  Framebuffer(Framebuffer&& other) noexcept;
  Framebuffer& operator=(Framebuffer&& other) noexcept;

  /// Makes it the target of drawing, with the whole of it as viewport.
  void bind() const;
  void clear(int attachment, const float rgba[4]);
  void clear(int attachment, std::uint32_t value);
  void clear_depth(float depth);

  int width() const { return width_; }
  int height() const { return height_; }
  const Texture& colour(int attachment) const { return colours_.at(static_cast<std::size_t>(attachment)); }
  const Texture& depth() const;  ///< precondition: made with depth

  /// Pixels of one attachment, rows from below.
  std::vector<std::uint8_t> read_rgba8(int attachment = 0) const;  ///< 4 bytes a pixel
  std::vector<std::uint32_t> read_r32ui(int attachment = 0) const;
  std::vector<float> read_float(int attachment = 0) const;  ///< kR32f: 1 a pixel, kRgba32f: 4
  std::vector<float> read_depth() const;

 private:
  void read_pixels(int attachment, unsigned format, unsigned type, void* out) const;
  unsigned id_ = 0;
  int width_ = 0, height_ = 0;
  std::vector<Texture> colours_;
  std::vector<Texture> depth_;  // none or one
};

}  // namespace palpate::gl
