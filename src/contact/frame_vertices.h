#pragma once
#include <vector>

#include "palpate/contact/side.h"

namespace palpate::contact {

/// Vertices of a rigid surface at a state: what SurfaceState is for a soft one.
class FrameVertices {
 public:
  /// @throws InternalError for a missing frame, and for faces that name a vertex which is not there
  explicit FrameVertices(FrameSurface surface);

  void update(const dynamics::StateView& state);

  int vertex_count() const { return static_cast<int>(surface_.mesh.vertices.cols()); }
  const Points& positions() const { return positions_; }  ///< world [m]
  Vec3 position(int vertex) const { return positions_.col(vertex); }
  Vec3 velocity(int vertex, const dynamics::StateView&) const {
    return twist_.at(positions_.col(vertex) - pose_.translation);
  }
  SurfacePoint vertex_point(int vertex) const;
  /// One third of the area vectors of the adjacent faces, world [m^2]; outward.  Of vertices in `wanted`.
  void area_vectors(const std::vector<char>& wanted, Points& areas) const;
  double mean_edge() const { return mean_edge_; }  ///< of the faces [m]

  void add_vertex_pattern(dynamics::PatternBuilder&) const {}  // a frame has no nodes
  std::uint64_t vertex_pattern_version() const { return 0; }

 private:
  FrameSurface surface_;
  Points areas_;  ///< in the frame
  double mean_edge_ = 0.0;
  Pose pose_;
  Mat3 R_ = Mat3::Identity();
  Twist twist_;
  Points positions_;
};

}  // namespace palpate::contact
