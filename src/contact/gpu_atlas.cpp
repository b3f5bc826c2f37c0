#include "contact/gpu_atlas.h"

#include <algorithm>

#include "palpate/core/error.h"

namespace palpate::contact {

std::size_t GpuAtlas::pack(std::span<DepthRequest* const> requests, int largest) {
  constexpr int kWidth = 1024;  // A few tiles of the usual sizes.
  const auto blocks_of = [](int pixels) { return (pixels + kBlock - 1) / kBlock; };
  tiles_.clear();
  blocks_.clear();
  width_ = height_ = 0;
  pixels_ = 0;
  int x = 0, y = 0, row_height = 0;
  for (const DepthRequest* request : requests) {
    const ContactCamera& camera = request->camera;
    if (!camera.sees_something()) {
      tiles_.emplace_back();
      continue;
    }
    PALPATE_CHECK(camera.width <= largest && camera.height <= largest, "contact image of {} x {}, at most {}",
                  camera.width, camera.height, largest);
    const int columns = blocks_of(camera.width), rows = blocks_of(camera.height);
    if (x > 0 && x + kBlock * columns > std::min(largest, kWidth)) {
      x = 0;
      y += row_height;
      row_height = 0;
    }
    const bool full = y + kBlock * rows > largest || tiles_.size() == kTiles ||
                      static_cast<int>(blocks_.size()) + columns * rows > kBlocks;
    if (full && !tiles_.empty()) return tiles_.size();
    const auto number = static_cast<std::uint32_t>(tiles_.size());
    // Rounding in single precision and the rasteriser's subpixel grid; the exact gap is tested later.
    constexpr double kDepthRounding = 1e-4;
    AtlasTile& tile = tiles_.emplace_back();
    tile.x = static_cast<std::uint32_t>(x);
    tile.y = static_cast<std::uint32_t>(y);
    tile.width = static_cast<std::uint32_t>(camera.width);
    tile.height = static_cast<std::uint32_t>(camera.height);
    tile.largest_gap =
        static_cast<float>(request->candidate_gap / (camera.far - camera.near) + kDepthRounding);
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column)
        blocks_.push_back(number << 16 | static_cast<std::uint32_t>(row << 8 | column));
    pixels_ += static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
    x += kBlock * columns;
    row_height = std::max(row_height, kBlock * rows);
    width_ = std::max(width_, x);
    height_ = std::max(height_, y + row_height);
  }
  return tiles_.size();
}

}  // namespace palpate::contact
