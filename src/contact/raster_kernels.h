#pragma once
#include <cstdint>

/// The loops of the rasteriser on the processor as plain functions on plain data: raster_lanes.cpp, compiled
/// for each instruction set.  No inline function and no template stands here: the linker would keep one copy,
/// made for whichever set it met first.
namespace palpate::contact {

/// One surface seen along w: a depth and a triangle for each pixel, row by row.
struct RasterTarget {
  float* depth = nullptr;  ///< least w so far
  std::int32_t* triangle =
      nullptr;  ///< whose it is, with kRasterLayered where a second layer was met; -1: none
  int width = 0, height = 0;
  int stride = 0;  ///< of a row; a multiple of kRasterLanes
};
constexpr std::int32_t kRasterLayered = 1 << 30;
constexpr int kRasterLanes = 16;  ///< the most of any set; targets are aligned to as many floats

struct RasterPair {
  std::uint32_t pixel, a, b, layered;
};

struct RasterKernels {
  /// Draws the triangles whose area in (x, y) has the sign of `side`; of equal depths the one that was drawn
  /// first stays.
  /// @param vertices  x, y [pixels] and w of each  @param corners  three vertices each
  /// @param layer_gap  depths at a pixel that differ by more are layers; by less, neighbours at their edge
  void (*draw)(const float* vertices, const std::int32_t* corners, int count, float side, float layer_gap,
               const RasterTarget& target);
  /// Pixels where both are seen, with w_a + minus_w_b <= largest_gap, in the order of the pixels.
  /// @param b  drawn with -w as its depth  @param out  room for all pixels  @return how many
  int (*pair)(const RasterTarget& a, const RasterTarget& b, float largest_gap, RasterPair* out);
};

const RasterKernels& best_raster_kernels();

}  // namespace palpate::contact
