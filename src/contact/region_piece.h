#pragma once
#include <vector>

#include "contact/depth_image.h"
#include "contact/image_side.h"

namespace palpate::contact {

/// The faces of a region on one side, with vertices of their own.
class RegionPiece {
 public:
  /// @param local  scratch of the side, which its regions share: by vertex, -1 outside of this call
  void take(const ImageSide& whole, const std::vector<int>& wanted, std::vector<int>& local);
  /// Along these axes, those whose normal has the sign `side` along the plane's: what faces away lies behind
  /// skin of its own body, which may be in another region.
  void see(const ContactAxes& axes, double side, Patch& patch);

  /// Of the patch that was seen last.
  PatchSource source(ImageSide& side) const { return {&side, wanted_, numbers_}; }

  bool sees_nothing() const { return face_of_.empty(); }
  /// In the whole surface, of one of the patch's faces.
  int face_of(int face) const { return face_of_[static_cast<std::size_t>(face)]; }

 private:
  Faces faces_;
  std::vector<int> face_of_, numbers_;  ///< of the patch's faces: in the surface, in `wanted_`
  std::vector<int> wanted_;
  Faces corners_;
  std::vector<int> taken_;  ///< the surface's vertices
  Points world_;            ///< where these are
};

}  // namespace palpate::contact
