#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "contact/contact_view.h"

namespace palpate::contact {

/// Two triangles that face each other along a line: indices into the patches' `visible`.
struct FacePair {
  std::uint32_t at;  ///< which line: of an image row * width + column of its pixel
  std::uint32_t a, b;
};

/// One image that a contact region asks for, and the answer.
struct DepthRequest {
  const Patch *a = nullptr, *b = nullptr;
  ContactCamera camera;
  double candidate_gap = 0.0;  ///< [m]

  std::vector<FacePair> pairs;         ///< as DepthImage::find_pairs has them
  std::vector<std::uint32_t> layered;  ///< likewise
};

/// The two images of a contact region, both seen along the normal: of a the lowest point above each pixel's
/// middle counts, of b the highest.  Faces that are turned away (a's that face up, b's that face down) are
/// not drawn: body of their own side lies before them.  Coordinates may be single precision: an image decides
/// who faces whom, never how deep (facing.h).
class DepthImage {
 public:
  virtual ~DepthImage() = default;
  /// The pixels where both are seen and the gap is less than `candidate_gap`, or a little more.
  /// @param pairs    ascending by pixel; of one pixel several from lines that tell layers apart
  /// @param layered  those of these pixels where more than one layer of a or of b was seen, so that the pair
  ///   may not be all that there is; ascending.  Where triangles share an edge, a pixel on it may be named.
  virtual void find_pairs(const Patch& a, const Patch& b, const ContactCamera& camera, double candidate_gap,
                          std::vector<FacePair>& pairs, std::vector<std::uint32_t>& layered) = 0;
  /// Answers all requests, which may be of different regions and pairs of bodies.  On the GPU many at once
  /// cost little more than one; on the processor each costs what it costs by itself.
  virtual void answer(std::span<DepthRequest* const> requests) {
    for (DepthRequest* r : requests)
      find_pairs(*r->a, *r->b, r->camera, r->candidate_gap, r->pairs, r->layered);
  }
};

/// @param pixels  most along an edge
std::unique_ptr<DepthImage> make_gpu_image(int pixels);  ///< opens the GL context
std::unique_ptr<DepthImage> make_cpu_image();
/// Exact lines through the pixels' middles (exact_lines.h): all layers, none to be named.
std::unique_ptr<DepthImage> make_exact_image();

}  // namespace palpate::contact
