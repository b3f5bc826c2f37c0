#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "contact/gpu_atlas.h"
#include "contact/gpu_surface.h"
#include "palpate/gl/framebuffer.h"
#include "palpate/gl/program.h"
#include "palpate/gl/timestamps.h"

namespace palpate::contact {

/// The images of all contact regions of a query at once, on the GPU.
///
/// The surfaces are in its memory (gpu_surface.h): a query sends cameras, and which ranges of faces each
/// region holds.  Each request has a rectangle of one atlas.  There each surface is drawn along the normal
/// with its faces' numbers as colours: of a the least depth is kept, of b the greatest (an orthographic depth
/// is linear in w).  One compute pass compares the two and appends the pixels where both are seen, nearer
/// than the candidate gap, to one compact list, in memory that the processor sees.  One fence, and it is
/// read: sorted by request and pixel, so the order of atomic appends leaves no trace.
/// Coordinates are single precision about the body's origin: they decide who faces whom, never how deep.
class GpuImage final : public DepthImage {
 public:
  GpuImage();  ///< opens the GL context
  /// Draws one face of each into a small tile.
  void prepare(ImageSide& a, ImageSide& b) override;
  void start_query() override { surfaces_.start_query(); }
  void answer(std::span<DepthRequest* const> requests) override;
  const GpuSurfaces& surfaces() const { return surfaces_; }

 private:
  /// As glMultiDrawElementsIndirect reads it, and behind it the number of the range's first face.
  struct Draw {
    std::uint32_t count, instances, first_index, base_vertex, base_instance, first_face;
  };
  /// One side of one request: its draws, one behind the other.
  struct Layer {
    GpuSurface* surface;
    std::size_t first_draw, draw_count;
  };
  struct Found {
    std::uint32_t at, a, b;  ///< tile and pixel; faces as the region counts them
  };
  void answer_tiles(std::span<DepthRequest* const> requests);
  void send(std::span<DepthRequest* const> requests);
  Layer add_draws(const PatchSource& source);
  void draw(std::span<DepthRequest* const> requests, bool of_a);
  void append_pairs();
  void hand_out(std::span<DepthRequest* const> requests);

  gl::Program draw_, pair_;
  gl::Timestamps instants_{3};  ///< before the passes, between them and the gathering, behind it
  GpuSurfaces surfaces_;
  GpuAtlas atlas_;
  std::unique_ptr<gl::Framebuffer> target_a_, target_b_;
  gl::MappedBuffer draws_sent_, tiles_sent_, pairs_found_;
  gl::Buffer count_;
  std::vector<Draw> draws_;
  std::vector<Layer> layers_;              ///< of a and b of each request in turn
  std::vector<std::vector<Found>> found_;  ///< by request
  std::vector<std::uint32_t> found_at_;    ///< by pixel: index into its `found_`
  std::vector<std::int32_t> visible_a_,
      visible_b_;  ///< by the region's faces: index into `visible`, -1: none
};

}  // namespace palpate::contact
