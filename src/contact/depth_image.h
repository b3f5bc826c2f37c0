#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "contact/contact_view.h"

namespace palpate::contact {

class ImageSide;

/// Two triangles that face each other at a pixel's middle: indices into the patches' `visible`.
struct FacePair {
  std::uint32_t at;  ///< row * width + column of the pixel
  std::uint32_t a, b;
};

/// Where a patch's faces are on the whole surface.
struct PatchSource {
  ImageSide* side = nullptr;
  std::span<const int> faces = {};  ///< of the surface, by the patch's faces
};

/// The image that a contact region asks for, and the answer.
struct DepthRequest {
  const Patch *a = nullptr, *b = nullptr;
  ContactCamera camera;
  double candidate_gap = 0.0;  ///< [m]
  ContactAxes axes;
  PatchSource from_a, from_b;

  /// The pixels where both are seen and the gap is less than `candidate_gap`, or a little more; ascending.
  std::vector<FacePair> pairs;
};

/// Wall time of an answer by what was done,  [s].
struct ImageTimes {
  double upload = 0.0;    ///< what was made, or sent, of the surfaces
  double passes = 0.0;    ///< both surfaces drawn
  double gather = 0.0;    ///< both compared, and the pairs brought into one list
  double readback = 0.0;  ///< all else: commands, fence, and the list handed out by request
};

/// The two images of a contact region, both seen along the normal: of a the lowest point above each pixel's
/// middle counts, of b the highest.  Faces that are turned away (a's that face up, b's that face down) are
/// not drawn: body of their own side lies before them.  Coordinates are single precision: an image decides
/// who faces whom, never how deep (facing.h).
class DepthImage {
 public:
  virtual ~DepthImage() = default;
  /// Makes at once what the first requests of these sides would have to: memory, surfaces in it, programs
  /// that a driver compiles when they are first used.  First touch then takes as long as any other.
  /// @pre both are updated
  virtual void prepare(ImageSide& a, ImageSide& b) = 0;
  /// Surfaces may have moved since the last request.
  virtual void start_query() = 0;
  /// Answers all requests: many at once cost little more than one.
  virtual void answer(std::span<DepthRequest* const> requests) = 0;
  const ImageTimes& times() const { return times_; }  ///< of the last answer

 protected:
  ImageTimes times_;
};

/// Opens the GL context.  @throws Error where no EGL device can be opened, with the package that brings it
std::unique_ptr<DepthImage> make_depth_image();

}  // namespace palpate::contact
