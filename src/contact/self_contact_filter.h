#pragma once
#include <vector>

#include "contact/surface_state.h"

namespace palpate::contact {

/// A point of a body's skin: the tetrahedron that carries it, and where it is at rest (of the body) and now
/// (in the world) [m].
struct SkinPoint {
  int tet;
  Vec3 rest, now;
};

/// Tells contact of a body with itself from the body's own thickness; the derivation is in
/// self_contact_filter.cpp.
class SelfContactFilter {
 public:
  /// @param skin        lives longer
  /// @param rest_nodes  of its tetrahedra [m]
  SelfContactFilter(const SurfaceState& skin, Points rest_nodes);

  /// The point of a face with these weights of its corners, which is now at `world`.
  SkinPoint point(int face, const Vec3& weights, const Vec3& world) const;
  /// Whether skin at a and at b, each behind the other, overlap because one has come into the other's tissue,
  /// at the skin's last update.
  bool in_contact(const SkinPoint& a, const SkinPoint& b) const {
    return ends_elsewhere(a, b) || ends_elsewhere(b, a);
  }

 private:
  /// A straight way through the tetrahedra: the part of it that lies in them, the last of them, and the
  /// weights of the way's end there.
  struct Way {
    double inside;
    int tet;
    Eigen::Vector4d end;
  };
  Way walk(int tet, const Vec3& from, const Vec3& to) const;
  bool ends_elsewhere(const SkinPoint& from, const SkinPoint& to) const;

  const SurfaceState& skin_;
  Points rest_nodes_, rest_vertices_;
  Tets across_;               ///< the tetrahedron beyond the face opposite to each corner; -1: none
  double skin_distance_ = 0;  ///< how far skin may lie outside of the tetrahedra at rest [m]
};

}  // namespace palpate::contact
