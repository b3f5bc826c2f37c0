#pragma once
#include "palpate/mesh/mesh.h"
#include "palpate/shapes/shapes.h"

namespace palpate::shapes {

/// What a surface is made from.
struct Blueprint {
  Implicit inside;
  std::function<double(const Vec3&)> size;  ///< wanted edge length there, as a factor; empty: 1 everywhere
  /// the body lies strictly between (symmetric: only high.x counts)
  Vec3 low, high;
  /// spacing of the first contour: half of the narrowest gap or part [m]
  double lattice = 0.0;
  double lipschitz = 1.5;  ///< |inside(p) - inside(q)| <= lipschitz |p - q|
  /// inside(p) = inside(mirrored p) about x = 0; the mesh is then its own mirror image, to the bit
  bool symmetric = false;
};

/// A closed surface of nearly equilateral triangles with
/// `vertices` vertices (one more or less where it is symmetric).
TriMesh contour(const Blueprint& blueprint, int vertices);

/// The zero set by marching tetrahedra on the cubic lattice, each cube cut in six along its diagonal: closed
/// and oriented outwards, except along x = 0 where a symmetric body is cut.  Triangles of any quality.
TriMesh march(const Blueprint& blueprint);

}  // namespace palpate::shapes
