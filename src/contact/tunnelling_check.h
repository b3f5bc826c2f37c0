#pragma once
#include <functional>
#include <vector>

#include "palpate/core/types.h"
#include "palpate/mesh/mesh.h"

namespace palpate::contact {

/// Motion of some faces of a closed surface between two times, in the same axes; vertices move along straight
/// lines in between.
struct SurfaceMotion {
  Faces faces;                   ///< Faces, by local vertex indices, oriented outwards.
  Points before, now;            ///< Vertex positions at both times [m].
  std::vector<int> vertex_of{};  ///< Index of each vertex in the whole surface.
  std::vector<int> face_of{};    ///< Index of each face in the whole surface.
};

/// Counts the vertices of one surface that tunnelled through another: outside before and now, inside in
/// between, so that neither query found them in contact.
///
/// With a vertex x and the corners p0, p1, p2 of a face linear in the time t in [0, 1], the four points are
/// coplanar where the cubic
///
///   f(t) = (x - p0) . [(p1 - p0) x (p2 - p0)] = d0.c0 + t (d'.c0 + d0.c1) + t^2 (d'.c1 + d0.c2) + t^3 d'.c2,
///   d = x - p0,  c0 + t c1 + t^2 c2 = (p1 - p0) x (p2 - p0),
///
/// is zero. If the vertex is inside the triangle at that time, it enters (f decreases) or leaves (f
/// increases). It tunnelled if it entered first and left last, and if its path in between was longer than a
/// threshold, which excludes grazed edges.
class TunnellingCheck {
 public:
  /// Counts tunnelled vertices. Where displacements are so long that all vertices would have to be tested
  /// against all faces, the count is terminated and excludes the untested vertices: the cost of a query
  /// remains bounded, even for a diverged simulation.
  /// @param least_way  threshold of the path inside, relative to the face entered [m]
  /// @param may_collide   for self-contact: (vertex, face) by their indices in the whole surface; else null
  long count(const SurfaceMotion& vertices, const SurfaceMotion& faces, double least_way,
             const std::function<bool(int vertex, int face)>& may_collide = {});

  /// Returns how often count() was terminated early.
  long given_up() const { return given_up_; }

 private:
  struct FaceBox {
    Vec3 low, high;
    int face;
  };
  std::vector<FaceBox> boxes_;
  long given_up_ = 0;
};

}  // namespace palpate::contact
