#pragma once
#include <vector>

#include "contact/surface_state.h"

namespace palpate::contact {

/// Point of a body's skin: the tetrahedron that carries it, and its position at rest (body axes) and now
/// (world) [m].
struct SkinPoint {
  int tet;
  Vec3 rest, now;
};

/// Distinguishes self-contact of a body from overlap across the body's thickness; derivation in
/// self_contact_filter.cpp.
class SelfContactFilter {
 public:
  /// @param skin        must outlive the filter
  /// @param rest_nodes  nodes of its tetrahedra at rest [m]
  SelfContactFilter(const SurfaceState& skin, Points rest_nodes);

  /// Returns the point of a face with these barycentric weights, which is now at `world`.
  SkinPoint point(int face, const Vec3& weights, const Vec3& world) const;
  /// Returns whether skin points a and b, each behind the other, overlap because one has entered the other's
  /// tissue, at the skin's last update.
  bool in_contact(const SkinPoint& a, const SkinPoint& b) const {
    return ends_elsewhere(a, b) || ends_elsewhere(b, a);
  }

 private:
  /// Straight path through the tetrahedra: the fraction of it inside them, the last tetrahedron, and the
  /// weights of the path's end in it.
  struct Way {
    double inside;
    int tet;
    Eigen::Vector4d end;
  };
  Way walk(int tet, const Vec3& from, const Vec3& to) const;
  bool ends_elsewhere(const SkinPoint& from, const SkinPoint& to) const;

  const SurfaceState& skin_;
  Points rest_nodes_, rest_vertices_;
  Tets across_;               ///< Tetrahedron across the face opposite to each corner; -1: none.
  double skin_distance_ = 0;  ///< Largest distance of the skin outside the tetrahedra at rest [m].
};

}  // namespace palpate::contact
