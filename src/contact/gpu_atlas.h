#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "contact/depth_image.h"

namespace palpate::contact {

/// Rectangle of one request in the atlas [pixels].
struct AtlasTile {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
  float largest_gap = 0.0f;  ///< Largest gap, relative to the slab; pixels with a larger gap are excluded.
};

/// Layout of the images of many requests in one atlas: in rows, from the left.
class GpuAtlas {
 public:
  static constexpr int kBlock = 16;      ///< Edge of a work group of pair.comp; tiles start at its multiples.
  static constexpr int kTiles = 256;     ///< Largest number of tiles: an index has 8 bits.
  static constexpr int kBlocks = 65536;  ///< Largest number of blocks, sufficient for the largest tile.

  /// Places as many requests as there is room for, at least one, and returns their number. Requests that see
  /// nothing get a tile without pixels.
  /// @param largest  largest edge of a texture
  std::size_t pack(std::span<DepthRequest* const> requests, int largest);

  /// Returns the tiles of the requests, in their order.
  std::span<const AtlasTile> tiles() const { return tiles_; }
  /// Returns tile, row and column of each block of pixels, packed into 16, 8 and 8 bits.
  std::span<const std::uint32_t> blocks() const { return blocks_; }
  int width() const { return width_; }  ///< Width in use [pixels].
  int height() const { return height_; }
  std::size_t pixels() const { return pixels_; }  ///< Number of pixels of all tiles.

 private:
  std::vector<AtlasTile> tiles_;
  std::vector<std::uint32_t> blocks_;
  int width_ = 0, height_ = 0;
  std::size_t pixels_ = 0;
};

}  // namespace palpate::contact
