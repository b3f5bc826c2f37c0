#pragma once
#include "palpate/mesh/mesh.h"
#include "shapes/shapes.h"

namespace palpate::shapes {

/// Definition of a surface to be contoured.
struct Blueprint {
  Implicit inside;
  std::function<double(const Vec3&)> size;  ///< target edge length as a position-dependent factor; empty: 1
  /// Box that strictly contains the body (symmetric: of low.x and high.x only high.x is used).
  Vec3 low, high;
  /// Spacing of the first contour: half of the narrowest gap or part [m].
  double lattice = 0.0;
  double lipschitz = 1.5;  ///< |inside(p) - inside(q)| <= lipschitz |p - q|
  /// inside(p) = inside(mirrored p) about x = 0; the mesh is then bitwise its mirror image.
  bool symmetric = false;
};

/// Returns a closed surface of nearly equilateral triangles with `vertices` vertices (plus or minus one if
/// symmetric).
TriMesh contour(const Blueprint& blueprint, int vertices);

/// Returns the zero set by marching tetrahedra on the cubic lattice, each cube cut in six along its diagonal:
/// closed and oriented outwards, except along x = 0 where a symmetric body is cut.  Triangles may have any
/// quality.
TriMesh march(const Blueprint& blueprint);

}  // namespace palpate::shapes
