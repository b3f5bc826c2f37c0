#pragma once
#include <vector>

#include "palpate/contact/side.h"

namespace palpate::contact {

/// MaterialPoints at a state: what SurfaceState and FrameVertices are for the vertices of a surface, with the
/// same names, so that AnalyticSource takes any of the three.
class MaterialPointState {
 public:
  /// @throws InternalError where areas and triangles differ in number, or points of nodes have no block
  explicit MaterialPointState(MaterialPoints points);

  void update(const dynamics::StateView& state);

  int vertex_count() const { return static_cast<int>(points_.at.size()); }
  /// In the world, evaluated when it is asked for: what does not touch costs nothing between queries [m].
  Vec3 position(int point) const;
  Vec3 velocity(int point, const dynamics::StateView& state) const;
  double fastest(const dynamics::StateView& state) const;  ///< bound on any point's speed [m/s]

  double farthest_from(const Vec3& x) const;  ///< bound on any point's distance from x [m]

  // The way since the points were last kept.
  void keep();                          ///< as they are now
  double way() const;                   ///< bound on any point's displacement [m]; infinite before keep()
  Vec3 kept_position(int point) const;  ///< @pre kept
  /// Its nodes are counted over all node blocks.
  SurfacePoint vertex_point(int point) const;
  const MaterialPoints& points() const { return points_; }
  double mean_edge() const;  ///< of squares of the points' mean area [m]

  void add_vertex_pattern(dynamics::PatternBuilder& pattern) const;
  std::uint64_t vertex_pattern_version() const { return pattern_version_; }

 private:
  bool is_rigid() const { return points_.motion != nullptr; }
  Vec3 position(int point, const Points& nodes, const Mat3& R, const Vec3& t) const;
  const SurfacePoint& at(int point) const { return points_.at[static_cast<std::size_t>(point)]; }

  MaterialPoints points_;
  int node_offset_ = 0;
  std::uint64_t pattern_version_ = 0;
  double weight_sum_ = 1.0;  ///< largest sum |w| of a point
  double radius_ = 0.0;      ///< largest distance of a rigid one from the frame's origin [m]
  bool is_kept_ = false;
  Points nodes_, kept_nodes_;  ///< of the block, now and when they were kept
  Pose pose_, kept_pose_;
  Mat3 R_ = Mat3::Identity(), kept_R_ = Mat3::Identity();
  Twist twist_;
};

}  // namespace palpate::contact
