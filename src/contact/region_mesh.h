#pragma once
#include <vector>

#include "contact/image_side.h"

namespace palpate::contact {

/// Faces of a contact region on one side, with local vertices.
class RegionMesh {
 public:
  /// Gathers faces of a surface.
  /// @param whole  the surface  @param faces  faces by their indices in the whole surface
  /// @param local  scratch shared by all regions of a side: per vertex of the surface, -1 outside this call
  void take(const ImageSide& whole, const std::vector<int>& faces, std::vector<int>& local);

  /// Index in the whole surface, per face.
  const std::vector<int>& surface_faces() const { return surface_faces_; }
  const Faces& faces() const { return faces_; }         ///< Corners, as local vertices.
  const Points& vertices() const { return vertices_; }  ///< World positions of the local vertices [m].

 private:
  std::vector<int> surface_faces_;
  Faces faces_;
  std::vector<int> taken_;  ///< Index in the whole surface, per local vertex.
  Points vertices_;
};

}  // namespace palpate::contact
