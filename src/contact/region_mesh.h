#pragma once
#include <vector>

#include "contact/image_side.h"

namespace palpate::contact {

/// The faces of a contact region on one side, with vertices of their own: gathered once a query, for all
/// images of the region and of its parts.
class RegionMesh {
 public:
  /// Consecutive faces of one proxy, and their bounding box in world axes.
  struct Chunk {
    int first = 0, end = 0;  ///< faces of the mesh
    int proxy = 0;
    Vec3 centre = Vec3::Zero(), half = Vec3::Zero();  ///< world [m]
  };

  /// @param faces  of the whole surface, those of one proxy consecutive
  /// @param proxy_of_face  by face of the whole surface
  /// @param local  scratch that all regions of a side share: by vertex of the surface, -1 outside of this
  /// call
  void take(const ImageSide& whole, const std::vector<int>& faces, const std::vector<int>& proxy_of_face,
            std::vector<int>& local);

  const std::vector<int>& surface_faces() const { return surface_faces_; }  ///< by face: in the surface
  const Faces& faces() const { return faces_; }                             ///< corners, by own vertices
  int face_count() const { return static_cast<int>(surface_faces_.size()); }
  const Points& vertices() const { return vertices_; }  ///< world [m]
  const std::vector<Chunk>& chunks() const { return chunks_; }

 private:
  std::vector<int> surface_faces_;
  Faces faces_;
  std::vector<int> taken_;  ///< the surface's vertices
  Points vertices_;
  std::vector<Chunk> chunks_;
};

}  // namespace palpate::contact
