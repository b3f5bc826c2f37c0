#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "contact/depth_image.h"

namespace palpate::contact {

/// A request's rectangle of the atlas [pixels].
struct AtlasTile {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
  float largest_gap = 0.0f;  ///< of the slab; pixels farther apart are excluded
};

/// Where the images of many requests stand side by side: in rows, from the left.
class GpuAtlas {
 public:
  static constexpr int kBlock = 16;      ///< edge of a work group of pair.comp; tiles start at multiples
  static constexpr int kTiles = 256;     ///< at most: a tile's number has 8 bits
  static constexpr int kBlocks = 65536;  ///< at most: the largest tile has as many

  /// Takes as many requests as have room, at least one; returns how many.  Those that see nothing have a tile
  /// without pixels.
  /// @param largest  edge of a texture, at most
  std::size_t pack(std::span<DepthRequest* const> requests, int largest);

  std::span<const AtlasTile> tiles() const { return tiles_; }
  /// tile, row and column of each block of pixels: 16, 8 and 8 bits
  std::span<const std::uint32_t> blocks() const { return blocks_; }
  int width() const { return width_; }  ///< that is in use
  int height() const { return height_; }
  std::size_t pixels() const { return pixels_; }  ///< of all tiles

 private:
  std::vector<AtlasTile> tiles_;
  std::vector<std::uint32_t> blocks_;
  int width_ = 0, height_ = 0;
  std::size_t pixels_ = 0;
};

}  // namespace palpate::contact
