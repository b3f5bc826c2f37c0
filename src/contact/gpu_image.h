#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "contact/gpu_atlas.h"
#include "contact/gpu_surface.h"
#include "gl/framebuffer.h"
#include "gl/program.h"
#include "gl/timestamps.h"

namespace palpate::contact {

/// Renders the images of all contact regions of a query at once, on the GPU.
///
/// The surfaces reside in GPU memory (gpu_surface.h): a query sends cameras and the ranges of faces in each
/// region. Each request has a rectangle of one atlas. Each surface is drawn there along the normal, with face
/// indices as colours: for a the least depth is kept, for b the greatest (an orthographic depth is linear in
/// w). One compute pass compares the two and appends the pixels at which both are seen, with a gap below the
/// candidate gap, to one compact list in host-visible memory. After one fence the list is read and sorted by
/// request and pixel, so that the order of atomic appends does not affect the result. Coordinates are single
/// precision about the body's origin: they determine which triangles are opposite, never the gap.
class GpuImage final : public DepthImage {
 public:
  GpuImage();  ///< Opens the GL context.
  /// Draws one face of each side into a small tile.
  void prepare(ImageSide& a, ImageSide& b) override;
  void start_query() override { surfaces_.start_query(); }
  void answer(std::span<DepthRequest* const> requests) override;
  const GpuSurfaces& surfaces() const { return surfaces_; }

 private:
  /// Command of glMultiDrawElementsIndirect, followed by the number of the range's first face.
  struct Draw {
    std::uint32_t count, instances, first_index, base_vertex, base_instance, first_face;
  };
  /// Draws of one side of one request, stored contiguously.
  struct Layer {
    GpuSurface* surface;
    std::size_t first_draw, draw_count;
  };
  struct Found {
    std::uint32_t at, a, b;  ///< Tile and pixel; faces in the region's numbering.
  };
  void answer_tiles(std::span<DepthRequest* const> requests);
  void send(std::span<DepthRequest* const> requests);
  Layer add_draws(const PatchSource& source);
  void draw(std::span<DepthRequest* const> requests, bool of_a);
  void append_pairs();
  void distribute_pairs(std::span<DepthRequest* const> requests);

  gl::Program draw_, pair_;
  /// Timestamps before the passes, between passes and gathering, and after gathering.
  gl::Timestamps instants_{3};
  GpuSurfaces surfaces_;
  GpuAtlas atlas_;
  std::unique_ptr<gl::Framebuffer> target_a_, target_b_;
  gl::MappedBuffer draws_sent_, tiles_sent_, pairs_found_;
  gl::Buffer count_;
  std::vector<Draw> draws_;
  std::vector<Layer> layers_;              ///< Layers of a and b of each request in turn.
  std::vector<std::vector<Found>> found_;  ///< Pairs per request.
  std::vector<std::uint32_t> found_at_;    ///< Per pixel: index into the request's pairs.
  std::vector<std::int32_t> visible_a_,
      visible_b_;  ///< Per face of the region: index into `visible`, -1: none.
};

}  // namespace palpate::contact
