#pragma once
#include <functional>
#include <vector>

#include "palpate/core/types.h"
#include "palpate/mesh/mesh.h"

namespace palpate::contact {

/// Some faces of a closed surface at two times, in the same axes; vertices go straight on between them.
struct SurfaceWays {
  Faces faces;                   ///< of these vertices, outward
  Points before, now;            ///< [m]
  std::vector<int> vertex_of{};  ///< number of each vertex in the whole surface
  std::vector<int> face_of{};    ///< likewise of each face
};

/// Counts the vertices of one surface that went through another: outside before and now, inside on the way,
/// so that neither query saw them in contact.
///
/// With a vertex x and the corners p0, p1, p2 of a face all linear in the time t in [0, 1], they lie in one
/// plane where the cubic
///
///   f(t) = (x - p0) . [(p1 - p0) x (p2 - p0)] = d0.c0 + t (d'.c0 + d0.c1) + t^2 (d'.c1 + d0.c2) + t^3 d'.c2,
///   d = x - p0,  c0 + t c1 + t^2 c2 = (p1 - p0) x (p2 - p0),
///
/// is zero; there the vertex enters (f falls) or leaves (f rises) if it is inside the triangle.  It went
/// through if it entered first and left last, and its way in between was longer than a least one: not where
/// it only grazed an edge.
class PassedVertices {
 public:
  /// Where ways are so long that all would have to be looked at against all, it gives up, and what it has not
  /// looked at by then is not counted: a query's price stays within a bound, and a scene that has blown up
  /// goes on.
  /// @param least_way  inside, seen from where it entered [m]
  /// @param may_meet   of a surface against itself: (vertex, face), numbers in the whole surface; else null
  long count(const SurfaceWays& vertices, const SurfaceWays& faces, double least_way,
             const std::function<bool(int vertex, int face)>& may_meet = {});

  /// How often count() gave up.
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
