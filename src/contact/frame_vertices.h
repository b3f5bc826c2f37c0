#pragma once
#include <vector>

#include "palpate/contact/side.h"
#include "palpate/dynamics/matrix.h"

namespace palpate::contact {

/// Vertices of a rigid surface at a state: counterpart of SurfaceState for soft surfaces.
class FrameVertices {
 public:
  /// @throws InternalError for a missing frame, and for faces with invalid vertex indices
  explicit FrameVertices(FrameSurface surface);

  /// Evaluates pose, twist and positions at a state.
  void update(const dynamics::StateView& state);

  int vertex_count() const { return static_cast<int>(surface_.mesh.vertices.cols()); }
  const Points& positions() const { return positions_; }  ///< World positions [m].
  Vec3 position(int vertex) const { return positions_.col(vertex); }
  Vec3 velocity(int vertex, const dynamics::StateView&) const {
    return twist_.at(positions_.col(vertex) - pose_.translation);
  }
  /// Returns the contact point of a vertex.
  SurfacePoint vertex_point(int vertex) const;
  /// Computes one third of the area vectors of the faces adjacent to each vertex in `wanted`, world axes,
  /// outward [m^2].
  void area_vectors(const std::vector<char>& requested, Points& areas) const;
  double mean_edge() const { return mean_edge_; }  ///< Mean edge length of the faces [m].

  void add_vertex_pattern(dynamics::PatternBuilder&) const {}  // A frame has no nodes.
  std::uint64_t vertex_pattern_version() const { return 0; }

 private:
  FrameSurface surface_;
  Points areas_;  ///< Area vectors in the frame's axes.
  double mean_edge_ = 0.0;
  Pose pose_;
  Mat3 R_ = Mat3::Identity();
  Twist twist_;
  Points positions_;
};

}  // namespace palpate::contact
