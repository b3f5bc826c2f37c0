#pragma once
#include <vector>

#include "palpate/distance/skin.h"

namespace palpate::distance {

/// Largest number of parts of a face's edges: 384 points per face.
inline constexpr int kMostCuts = 16;

/// A material point of a skin and the rest area that it stands for.
struct ContactPoint {
  int face = 0;         ///< that carries it
  Vec3 weights;         ///< of the face's corners; sum 1
  double area = 0.0;    ///< [m^2]
  double coarse = 0.0;  ///< area in the embedded rule of lower order [m^2]
};

/// Returns the number n of parts of a face's edges, such that none is longer than `spacing` at rest; 1 where
/// the face is smaller, at most kMostCuts.
/// @param spacing  [m]; infinite: every face as it is
int cuts_of(const Skin& skin, int face, double spacing);

/// Points of a quadrature of the skin at rest: each face is cut into n^2 similar triangles, n of cuts_of();
/// three quarters of a triangle's area stand at its centroid and a twelfth at each corner.
///
/// That rule is exact for polynomials of degree 2 on each triangle with positive weights (of the second
/// moments about the centroid, which the corners alone overestimate fourfold, a quarter of the corners' share
/// is exact). Corners are shared by about six triangles, so it takes 3/2 points per triangle where rules with
/// interior points take three; those on an edge between faces of different n are not shared.  The centroids
/// alone, of degree 1, are the embedded rule.
///
/// Points are ordered by face, those of a face's corners with the first face that has them.
/// @param spacing  longest edge of the triangles [m], as for cuts_of()
/// @throws Error where the spacing is not positive
std::vector<ContactPoint> contact_points(const Skin& skin, double spacing);

}  // namespace palpate::distance
