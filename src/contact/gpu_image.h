#pragma once
#include <cstdint>
#include <vector>

#include "contact/depth_image.h"
#include "palpate/gl/buffer.h"
#include "palpate/gl/framebuffer.h"
#include "palpate/gl/program.h"

namespace palpate::contact {

/// The two images of a contact region on the GPU.
///
/// Each surface is drawn along the normal with its triangle numbers as colours: of a the least depth is kept,
/// of b the greatest (an orthographic depth is linear in w).  A compute pass compares the two and appends the
/// pixels where both are seen, nearer than the candidate gap, to a compact list; only that list comes back,
/// sorted by pixel, so the order of atomic appends leaves no trace.  The stencil counts the layers of each
/// pixel, kept or not; the rasteriser gives a pixel on a common edge to one triangle alone.
/// Coordinates are single precision about the region's origin: they decide who faces whom, never how deep.
class GpuImage final : public DepthImage {
 public:
  explicit GpuImage(int pixels);  ///< opens the GL context; the images are square, `pixels` an edge
  void find_pairs(const Patch& a, const Patch& b, const ContactCamera& camera, double candidate_gap,
                  std::vector<FacePair>& pairs, std::vector<std::uint32_t>& layered) override;

 private:
  struct Surface {
    gl::Framebuffer target;
    gl::Buffer vertices, triangles;
    gl::VertexArray layout;
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;
    explicit Surface(int pixels);
  };
  void draw(Surface& surface, const Patch& patch, const ContactCamera& camera, bool keep_least);
  void append_pairs(const ContactCamera& camera, double candidate_gap);

  int pixels_;
  gl::Program draw_, pair_;
  Surface a_, b_;
  gl::Buffer count_, list_;
};

}  // namespace palpate::contact
