#pragma once
#include <memory>

#include "palpate/core/pose.h"
#include "palpate/mesh/mesh.h"

/// Exact distances between rigid surfaces, for placing objects and for reports. Contact during a run uses
/// skin_contact.h, which evaluates gaps at material points.
namespace palpate::distance {

/// Signed distance between two objects.
struct Gap {
  /// Distance where they are separate; otherwise minus the depth of the deepest point, or zero where only
  /// edges cross [m].
  double distance = 0.0;
  Vec3 on_first = Vec3::Zero();  ///< Nearest point of the first object, or the deepest point [m].
  Vec3 on_second =
      Vec3::Zero();  ///< Nearest point of the second object, or the point nearest to that one [m].
  /// Returns the gap with the two objects exchanged.
  Gap reversed() const { return {distance, on_second, on_first}; }
};

/// Squared distance of two triangles, and the nearest points; zero where they intersect.
struct TrianglePair {
  double distance2 = 0.0;                                  ///< [m^2]
  Vec3 on_first = Vec3::Zero(), on_second = Vec3::Zero();  ///< [m]
};
/// Computes the distance of two triangles, one corner per column. If they do not intersect, their nearest
/// points are a corner of one and a point of the other, or points of two edges: 6 and 9 candidates.
TrianglePair nearest_of_triangles(const Mat3& a, const Mat3& b);

/// Closed surface that moves rigidly.
class RigidSurface {
 public:
  /// @param mesh  oriented outwards [m]
  /// @throws Error where the surface is not closed, or a face has no area
  explicit RigidSurface(TriMesh mesh);
  ~RigidSurface();
  RigidSurface(RigidSurface&&) noexcept;
  RigidSurface& operator=(RigidSurface&&) noexcept;

  void move(const Pose& pose);  ///< Places the mesh's axes in the world; at first they are the world's.
  /// Returns the gap of a point, the first object, to the surface: its depth is that of the point.
  Gap from_point(const Vec3& x) const;
  const Points& vertices() const { return vertices_; }  ///< Current vertices [m].

  /// Returns the exact distance of two surfaces; the depth is that of the deepest vertex of either. A search
  /// over both bounding-volume trees skips pairs of boxes that are farther apart than known points.
  friend Gap gap_between(const RigidSurface& first, const RigidSurface& second);

 private:
  struct Impl;
  TriMesh mesh_;
  Points vertices_;
  std::unique_ptr<Impl> impl_;
};
Gap gap_between(const RigidSurface& first, const RigidSurface& second);

}  // namespace palpate::distance
