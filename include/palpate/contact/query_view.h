#pragma once
#include <vector>

#include "palpate/core/types.h"

namespace palpate::contact {

/// The gap over the pixels of one contact region, as a query saw it.
struct RegionView {
  Mat3 axes = Mat3::Identity();  ///< columns u, v and the normal from b to a; world
  Vec3 origin = Vec3::Zero();    ///< of (u, v, w) [m]
  double u0 = 0.0, v0 = 0.0;     ///< lower left corner of the first pixel [m]
  double pixel = 0.0;            ///< edge of a pixel [m]
  int width = 0, height = 0;     ///< [pixels]
  /// One a pixel's middle, row by row upwards; negative is penetration; NaN: one of the surfaces is not
  /// there, or they are apart by more than the candidate gap [m].
  std::vector<double> gap;
  /// w of a's surface there [m]; that of b is w - gap.
  std::vector<double> height_a;
};

/// What pictures show of one pair's last query.
struct QueryView {
  std::vector<RegionView> regions;  ///< of images
  /// Corners of the convex hulls, not inflated, of each proxy in a region where something presses.
  std::vector<Points> proxies_a, proxies_b;
};

/// A contact sample where it stands now.
struct ContactPoint {
  Vec3 a, b;        ///< its points on the two surfaces [m]
  Vec3 normal;      ///< from b to a
  double gap;       ///< mean of what the point stands for [m], negative is penetration
  double own_gap;   ///< at the point itself [m]: above 0 where it lies outside, and some of that overlaps
  double pressure;  ///< [Pa]; 0 of a candidate that is apart
  double area;      ///< [m^2]
  int pair;         ///< which [[contact]] of the scene
};

}  // namespace palpate::contact
