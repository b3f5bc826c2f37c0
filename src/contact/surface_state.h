#pragma once
#include <vector>

#include "palpate/contact/contact_force.h"

namespace palpate::contact {

/// A NodeSurface at a state: where its vertices are, which nodes of the State they are.
class SurfaceState {
 public:
  /// @throws InternalError for faces that name a vertex which is not there
  explicit SurfaceState(NodeSurface surface);

  void update(const dynamics::StateView& state);

  int vertex_count() const { return static_cast<int>(surface_.node_of_vertex.size()); }
  int face_count() const { return static_cast<int>(surface_.faces.cols()); }
  const Faces& faces() const { return surface_.faces; }
  const Points& positions() const { return positions_; }
  /// Counted over all node blocks.
  int node(int vertex) const { return node_offset_ + surface_.node_of_vertex[static_cast<std::size_t>(vertex)]; }
  /// One third of the area vectors of the adjacent faces, deformed [m^2]; outward.  Sums over `faces` with a vertex in `wanted`.
  void area_vectors(const std::vector<char>& wanted, Points& areas) const;
  /// Mean length of the faces' edges at the last update [m].
  double mean_edge() const;

  void add_face_pattern(dynamics::PatternBuilder& pattern) const;
  std::uint64_t pattern_version() const { return pattern_version_; }

 private:
  NodeSurface surface_;
  int node_offset_ = 0;
  std::uint64_t pattern_version_ = 0;
  Points positions_;
};

/// One vertex of a surface as a contact point.
SurfacePoint vertex_point(int node);
/// A point of a frame, given in the world.
SurfacePoint frame_point(int frame, const Pose& inverse_pose, const Vec3& world);

}  // namespace palpate::contact
