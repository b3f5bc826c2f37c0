#pragma once
#include <vector>

#include "contact/image_side.h"

namespace palpate::contact {

/// The faces of a contact region on one side, with vertices of their own.
class RegionMesh {
 public:
  /// Gathers faces of a surface.
  /// @param faces  of the whole surface
  /// @param local  scratch that all regions of a side share: by vertex of the surface, -1 outside of this
  /// call
  void take(const ImageSide& whole, const std::vector<int>& faces, std::vector<int>& local);

  const std::vector<int>& surface_faces() const { return surface_faces_; }  ///< by face: in the surface
  const Faces& faces() const { return faces_; }                             ///< corners, by own vertices
  const Points& vertices() const { return vertices_; }                      ///< world [m]

 private:
  std::vector<int> surface_faces_;
  Faces faces_;
  std::vector<int> taken_;  ///< the surface's vertices
  Points vertices_;
};

}  // namespace palpate::contact
