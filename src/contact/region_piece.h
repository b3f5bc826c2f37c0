#pragma once
#include <vector>

#include "contact/depth_image.h"
#include "contact/image_side.h"

namespace palpate::contact {

/// The faces of a region on one side, with vertices of their own.
class RegionPiece {
 public:
  /// @param local  scratch of the side, which its regions share: by vertex, -1 outside of this call
  /// @param others  faces of other regions: never seen, but where they are turned away their body is left
  void take(const ImageSide& whole, const std::vector<int>& wanted, std::vector<int>& local,
            const std::vector<int>& others = {});
  /// Along these axes: those to be seen, whose normal has the sign `side` along the plane's; the others are
  /// turned away.
  void see(const ContactAxes& axes, double side, Patch& patch);

  /// Of the patch that was seen last.
  PatchSource source(ImageSide& side) const { return {&side, wanted_, numbers_}; }

  bool sees_nothing() const { return face_of_.empty(); }
  /// In the whole surface, of one of the patch's faces.
  int face_of(int face) const { return face_of_[static_cast<std::size_t>(face)]; }

 private:
  Faces faces_, away_;
  std::vector<int> face_of_, numbers_;  ///< of the patch's faces: in the surface, in `wanted_`
  std::vector<int> wanted_;             ///< faces, behind them those of other regions
  std::size_t own_ = 0;                 ///< how many are the region's own
  Faces corners_;
  std::vector<int> taken_;  ///< the surface's vertices
  Points world_;            ///< where these are
};

}  // namespace palpate::contact
