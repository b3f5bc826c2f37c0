// Many images in one texture: tiles do not overlap, blocks cover them, and as many fit as there is room for.
#include "contact/gpu_atlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

using namespace palpate::contact;

namespace {

struct Requests {
  std::vector<DepthRequest> all;
  std::vector<DepthRequest*> pointers;

  void add(int width, int height) {
    DepthRequest request;
    request.camera.width = width;
    request.camera.height = height;
    request.camera.far = 2.0;
    request.candidate_gap = 0.5;
    all.push_back(request);
  }
  std::span<DepthRequest* const> span() {
    pointers.clear();
    for (DepthRequest& request : all) pointers.push_back(&request);
    return pointers;
  }
};

/// Each pixel of each tile is in one block of that tile, and in no other tile.
void expect_sound(const GpuAtlas& atlas) {
  std::vector<int> owner(static_cast<std::size_t>(atlas.width()) * static_cast<std::size_t>(atlas.height()),
                         -1);
  std::size_t pixels = 0, covered = 0;
  const auto at = [&](std::uint32_t x, std::uint32_t y) -> int& {
    return owner.at(static_cast<std::size_t>(y) * static_cast<std::size_t>(atlas.width()) + x);
  };
  for (std::size_t i = 0; i < atlas.tiles().size(); ++i) {
    const AtlasTile& tile = atlas.tiles()[i];
    for (std::uint32_t y = 0; y < tile.height; ++y)
      for (std::uint32_t x = 0; x < tile.width; ++x, ++pixels) {
        ASSERT_EQ(at(tile.x + x, tile.y + y), -1);
        at(tile.x + x, tile.y + y) = static_cast<int>(i);
      }
  }
  for (const std::uint32_t block : atlas.blocks()) {
    const AtlasTile& tile = atlas.tiles()[block >> 16];
    for (std::uint32_t y = 16 * (block >> 8 & 0xff); y < 16 * (block >> 8 & 0xff) + 16; ++y)
      for (std::uint32_t x = 16 * (block & 0xff); x < 16 * (block & 0xff) + 16; ++x) {
        if (x >= tile.width || y >= tile.height) continue;
        ASSERT_EQ(at(tile.x + x, tile.y + y), static_cast<int>(block >> 16));
        at(tile.x + x, tile.y + y) = -2;  // each pixel once
        ++covered;
      }
  }
  EXPECT_EQ(covered, pixels);
  EXPECT_EQ(atlas.pixels(), pixels);
}

}  // namespace

TEST(GpuAtlas, TilesDoNotMeet) {
  Requests requests;
  for (int i = 0; i < 60; ++i) requests.add(1 + (i * 37) % 300, 1 + (i * 53) % 220);
  requests.add(0, 0);  // empty tile
  requests.add(17, 1);
  GpuAtlas atlas;
  EXPECT_EQ(atlas.pack(requests.span(), 16384), 62u);
  EXPECT_EQ(atlas.tiles()[60].width, 0u);
  EXPECT_EQ(atlas.tiles()[61].width, 17u);
  EXPECT_NEAR(atlas.tiles()[0].largest_gap, 0.25, 2e-4);
  EXPECT_GE(atlas.tiles()[0].largest_gap, 0.25f);
  expect_sound(atlas);
}

TEST(GpuAtlas, WhatHasNoRoomWaits) {
  Requests many;
  for (int i = 0; i < 300; ++i) many.add(16, 16);
  GpuAtlas atlas;
  EXPECT_EQ(atlas.pack(many.span(), 16384), 256u);  // a tile number has eight bits
  expect_sound(atlas);
  EXPECT_EQ(atlas.pack(many.span().subspan(256), 16384), 44u);
  expect_sound(atlas);

  Requests large;
  for (int i = 0; i < 5; ++i) large.add(500, 700);
  EXPECT_EQ(atlas.pack(large.span(), 1024), 2u);  // side by side; no room below
  EXPECT_LE(atlas.height(), 1024);
  expect_sound(atlas);

  Requests largest;
  for (int i = 0; i < 2; ++i) largest.add(4096, 4096);
  EXPECT_EQ(atlas.pack(largest.span(), 16384), 1u);  // 256 x 256 blocks each
  EXPECT_EQ(atlas.blocks().size(), 65536u);
}
