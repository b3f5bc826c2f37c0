#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "contact/contact_view.h"

namespace palpate::contact {

class ImageSide;

/// Two triangles that face each other along a line: indices into the patches' `visible`.
struct FacePair {
  std::uint32_t at;  ///< which line: of an image row * width + column of its pixel
  std::uint32_t a, b;
};

/// Where a patch's faces are on the whole surface.
struct PatchSource {
  ImageSide* side = nullptr;
  std::span<const int> faces = {};    ///< of the surface: those that the region holds
  std::span<const int> numbers = {};  ///< by the patch's faces: index into `faces`; empty: the same
  int number(int face) const { return numbers.empty() ? face : numbers[static_cast<std::size_t>(face)]; }
};

/// One image that a contact region asks for, and the answer.
struct DepthRequest {
  const Patch *a = nullptr, *b = nullptr;
  ContactCamera camera;
  double candidate_gap = 0.0;  ///< [m]
  /// what the patches were made of, for a backend that has surfaces in memory of its own
  ContactAxes axes;
  PatchSource from_a, from_b;

  /// The pixels where both are seen and the gap is less than `candidate_gap`, or a little more: ascending by
  /// pixel; of one pixel several from lines that tell layers apart.
  std::vector<FacePair> pairs;
  /// Those of these pixels where more than one layer of a or of b was seen, so that the pair may not be all
  /// that there is; ascending.  Where triangles share an edge, a pixel on it may be named.
  std::vector<std::uint32_t> layered;
};

/// Wall time of an answer by what was done, on whichever processor that was [s].
struct ImageTimes {
  double upload = 0.0;    ///< what was made, or sent, of the surfaces for the backend
  double passes = 0.0;    ///< both surfaces drawn; of exact lines all that they take
  double gather = 0.0;    ///< both compared, and the pairs brought into one list
  double readback = 0.0;  ///< on the GPU all else: commands, fence, and the list handed out by request
};

/// The two images of a contact region, both seen along the normal: of a the lowest point above each pixel's
/// middle counts, of b the highest.  Faces that are turned away (a's that face up, b's that face down) are
/// not drawn: body of their own side lies before them.  Coordinates may be single precision: an image decides
/// who faces whom, never how deep (facing.h).
class DepthImage {
 public:
  virtual ~DepthImage() = default;
  /// Makes at once what the first requests of these sides would have to: memory, surfaces in it, programs
  /// that a driver compiles when they are first used.  First touch then takes as long as any other.
  /// @pre both are updated
  virtual void prepare(ImageSide& a, ImageSide& b) {
    (void)a;
    (void)b;
  }
  /// Surfaces may have moved since the last request.
  virtual void start_query() {}
  /// Answers all requests, which may be of different regions and pairs of bodies.  On the GPU many at once
  /// cost little more than one; on the processor each costs what it costs by itself.
  virtual void answer(std::span<DepthRequest* const> requests) = 0;
  const ImageTimes& times() const { return times_; }  ///< of the last answer

 protected:
  ImageTimes times_;
};

std::unique_ptr<DepthImage> make_gpu_image();  ///< opens the GL context
/// What makes the images of sources with the backend "gpu": make_gpu_image, or in tests one that fails.
using MakeImage = std::unique_ptr<DepthImage> (*)();
MakeImage& gpu_image_maker();
std::unique_ptr<DepthImage> make_cpu_image();
/// Exact lines through the pixels' middles (exact_lines.h): all layers, none to be named.
std::unique_ptr<DepthImage> make_exact_image();

}  // namespace palpate::contact
