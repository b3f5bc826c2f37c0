#pragma once
#include <span>
#include <vector>

#include "palpate/contact/obstacle.h"
#include "palpate/contact/side.h"
#include "palpate/mesh/mesh.h"

namespace palpate::contact {

/// Returns the characteristic lengths of a closed surface.
CharacteristicLengths lengths_of(const TriMesh& closed);
/// Returns the spacing of a body's contact points against another body: the longest edge of the triangles
/// between them [m] (src/contact/material_points.cpp).
/// @param wanted_error  target relative error of the force, for a contact whose depth is an eighth of its
///   radius
double point_spacing(const CharacteristicLengths& own, const CharacteristicLengths& other,
                     double wanted_error);
/// Returns material points of a soft surface, for contact with an exact shape.
/// @param rest  vertices of the surface at rest [m]  @param body  tetrahedral mesh at rest; used for embedded
///   skins only
/// @param spacing  from point_spacing() [m]
/// @throws Error where the surface is not closed, or a face of it has no area
MaterialPoints material_points(const NodeSurface& surface, const Points& rest, const TetMesh& body,
                               double spacing);
/// Returns material points of a rigid surface. Throws like the overload for soft surfaces.
MaterialPoints material_points(const FrameSurface& surface, double spacing);
/// Returns the spacing of contact points on the surface of a shape against a body, as point_spacing() [m].
double shape_spacing(const CharacteristicLengths& shape, const CharacteristicLengths& body,
                     double wanted_error);

/// MaterialPoints at a state: counterpart of SurfaceState and FrameVertices, with the same member names, so
/// that AnalyticSource accepts each of the three.
class MaterialPointState {
 public:
  /// @throws InternalError where the numbers of areas and triangles differ, or where points on nodes have no
  ///   block
  explicit MaterialPointState(MaterialPoints points);

  /// Evaluates the nodes or the frame at a state.
  void update(const dynamics::StateView& state);
  /// Evaluates only the nodes of some points: until the next full update(), only their positions are valid.
  void update(const dynamics::StateView& state, std::span<const int> points);

  int vertex_count() const { return static_cast<int>(points_.at.size()); }
  /// Returns the world position of a point, evaluated on demand, so that points that do not touch cost
  /// nothing between queries [m].
  Vec3 position(int point) const;
  Vec3 velocity(int point, const dynamics::StateView& state) const;
  double fastest(const dynamics::StateView& state) const;  ///< Upper bound on the speed of all points [m/s].

  double farthest_from(const Vec3& x) const;  ///< Upper bound on the distance of all points from x [m].

  // Displacement since the points were last kept.
  void keep();         ///< Keeps the present configuration.
  double way() const;  ///< Upper bound on the displacement of all points [m]; infinite before keep().
  Vec3 kept_position(int point) const;  ///< World position when kept [m]. @pre keep() was called
  /// Returns the contact point, with nodes counted over all node blocks.
  SurfacePoint vertex_point(int point) const;
  const MaterialPoints& points() const { return points_; }
  double mean_edge() const;  ///< Edge of a square of the points' mean area [m].

  void add_vertex_pattern(dynamics::PatternBuilder& pattern) const;
  std::uint64_t vertex_pattern_version() const { return pattern_version_; }

 private:
  void update_frame(const dynamics::StateView& state);
  /// Checks the block and returns its node positions.
  const double* find_nodes(const dynamics::StateView& state);
  bool is_rigid() const { return points_.motion != nullptr; }
  Vec3 position(int point, const Points& nodes, const Mat3& R, const Vec3& t) const;
  const SurfacePoint& at(int point) const { return points_.at[static_cast<std::size_t>(point)]; }

  MaterialPoints points_;
  int node_offset_ = 0;
  std::uint64_t pattern_version_ = 0;
  double weight_sum_ = 1.0;  ///< Largest sum |w| of a point.
  double radius_ = 0.0;      ///< Largest distance of a rigid point from the frame's origin [m].
  bool is_kept_ = false;
  Points nodes_, kept_nodes_;  ///< Nodes of the block, now and when kept [m].
  Pose pose_, kept_pose_;
  Mat3 R_ = Mat3::Identity(), kept_R_ = Mat3::Identity();
  Twist twist_;
};

}  // namespace palpate::contact
