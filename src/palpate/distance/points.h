#pragma once
#include <algorithm>
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

/// Sum of the forces at some points, with its embedded estimate of the quadrature error: centroids alone and
/// corners alone are rules of degree 1, F = 3/4 F_centroids + 1/4 F_corners, and the estimate is their
/// difference, |F_corners - F_centroids| = 4 |F - F_centroids|.
struct EmbeddedSum {
  double sum = 0.0;           ///< of the forces' norms [N]
  double largest_term = 0.0;  ///< largest force of one point [N]
  Vec3 fine_less_coarse = Vec3::Zero();

  /// @param pressure  at a point, outward or inward [N/m^2]  @param area, coarse  as of ContactPoint [m^2]
  void add(const Vec3& pressure, double area, double coarse) {
    const double force = area * pressure.norm();
    sum += force;
    largest_term = std::max(largest_term, force);
    fine_less_coarse += (area - coarse) * pressure;
  }
  double error() const { return 4.0 * fine_less_coarse.norm(); }  ///< [N]
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
