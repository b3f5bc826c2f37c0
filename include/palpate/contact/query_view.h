#pragma once
#include <vector>

#include "palpate/core/types.h"

namespace palpate::contact {

/// Gap over the pixels of one contact region, as found by a query.
struct RegionView {
  Mat3 axes = Mat3::Identity();  ///< Columns u, v and the normal from b to a, in world axes.
  Vec3 origin = Vec3::Zero();    ///< Origin of (u, v, w) in the world [m].
  double u0 = 0.0, v0 = 0.0;     ///< Lower left corner of the first pixel [m].
  double pixel = 0.0;            ///< Edge length of a pixel [m].
  int width = 0, height = 0;     ///< Size of the image [pixels].
  /// Gap at each pixel's centre, row by row upwards [m]; negative is penetration. NaN where one of the
  /// surfaces is absent, or where the gap exceeds the candidate gap.
  std::vector<double> gap;
  /// w of a's surface at the same pixels [m]; for b it is w - gap.
  std::vector<double> height_a;
};

/// Picture data of one pair's last query.
struct QueryView {
  std::vector<RegionView> regions;  ///< Regions of the images.
  /// Corners of the convex hulls, not inflated, of the proxies in regions that are under pressure.
  std::vector<Points> proxies_a, proxies_b;
};

/// Contact sample evaluated at a state.
struct ContactPoint {
  Vec3 a, b;    ///< Its points on the two surfaces [m].
  Vec3 normal;  ///< Unit normal from b to a.
  double gap;   ///< Mean gap over the area that the point represents [m]; negative is penetration.
  /// Gap at the point [m]; positive where it lies outside although part of its area overlaps.
  double own_gap;
  double pressure;  ///< Pressure [Pa]; 0 for a candidate that is not in contact.
  double area;      ///< Area that the point represents [m^2].
  int pair;         ///< Index of the scene's [[contact]].
};

}  // namespace palpate::contact
