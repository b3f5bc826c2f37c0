#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "contact/contact_view.h"

namespace palpate::contact {

class ImageSide;

/// Two triangles that face each other at a pixel's centre: indices into the patches' `visible`.
struct FacePair {
  std::uint32_t at;  ///< row * width + column of the pixel.
  std::uint32_t a, b;
};

/// Mapping from a patch's faces to the whole surface.
struct PatchSource {
  ImageSide* side = nullptr;
  std::span<const int> faces = {};  ///< Face of the surface, per face of the patch.
};

/// Request for the image of a contact region, and its result.
struct DepthRequest {
  const Patch *a = nullptr, *b = nullptr;
  ContactCamera camera;
  double candidate_gap = 0.0;  ///< Candidate gap [m].
  ContactAxes axes;
  PatchSource from_a, from_b;

  /// Result: pixels at which both surfaces are seen and the gap is less than about `candidate_gap`;
  /// ascending.
  std::vector<FacePair> pairs;
};

/// Wall time of one call of answer() by stage [s].
struct ImageTimes {
  double upload = 0.0;    ///< Surface data created or sent.
  double passes = 0.0;    ///< Rendering of both surfaces.
  double gather = 0.0;    ///< Comparison of both images, and compaction of the pairs into one list.
  double readback = 0.0;  ///< Remainder: commands, fence, and distribution of the list to the requests.
};

/// Renderer of the two depth images of a contact region, both seen along the normal: of a the lowest point
/// above each pixel's centre counts, of b the highest. Back faces (a's that face up, b's that face down) are
/// not drawn: tissue of the same body lies in front of them. Coordinates are single precision: an image
/// determines which triangles are opposite, never the gap (triangle_pair_gap.h).
class DepthImage {
 public:
  virtual ~DepthImage() = default;
  /// Performs one-time work for these sides (memory, upload of surfaces, programs that a driver compiles at
  /// first use) ahead of the first request, so that first touch takes no longer than later requests.
  /// @pre both sides are updated
  virtual void prepare(ImageSide& a, ImageSide& b) = 0;
  /// Marks the start of a query: surfaces may have moved since the last one.
  virtual void start_query() = 0;
  /// Computes the results of all requests: many at once cost little more than one.
  virtual void answer(std::span<DepthRequest* const> requests) = 0;
  const ImageTimes& times() const { return times_; }  ///< Times of the last call of answer().

 protected:
  ImageTimes times_;
};

/// Opens the GL context and makes the renderer. @throws Error where no EGL device can be opened, with the
/// package that provides it
std::unique_ptr<DepthImage> make_depth_image();

}  // namespace palpate::contact
