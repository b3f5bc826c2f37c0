#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "contact/contact_view.h"

namespace palpate::contact {

/// Which triangles face each other at a pixel: indices into the patches' `visible`.
struct PixelPair {
  std::uint32_t pixel;  ///< row * width + column
  std::uint32_t a, b;
};

/// The two images of a contact region, both seen along the normal: of a the lowest point above each pixel's
/// middle counts, of b the highest.  Coordinates may be single precision: an image decides who faces whom,
/// never how deep (facing.h).
class DepthImage {
 public:
  virtual ~DepthImage() = default;
  /// The pixels where both are seen and the gap is less than `candidate_gap`, or a little more.
  /// @param pairs  ascending by pixel; of one pixel several where an image sees layers
  virtual void find_pairs(const Patch& a, const Patch& b, const ContactCamera& camera, double candidate_gap,
                          std::vector<PixelPair>& pairs) = 0;
};

/// @param pixels  most along an edge
std::unique_ptr<DepthImage> make_gpu_image(int pixels);  ///< opens the GL context
std::unique_ptr<DepthImage> make_cpu_image();
std::unique_ptr<DepthImage> make_exact_image();

}  // namespace palpate::contact
