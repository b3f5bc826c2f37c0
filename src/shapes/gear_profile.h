#pragma once
#include <vector>

#include "palpate/core/types.h"

namespace palpate::shapes {

using Point2 = Eigen::Vector2d;

/// Dimensions of a spur gear: involute teeth, no profile shift.  Lengths in metres.
struct GearSize {
  int teeth = 23;
  double module = 0.004;  ///< pitch diameter / teeth
  double pressure_angle_deg = 20.0;
  double clearance = 0.25;  ///< distance of the root from the other wheel's tips, in modules
  double fillet = 0.30;     ///< radius between flank and root, in modules
  double width = 0.020;     ///< along the axis
  double bore = 0.0125;     ///< radius of the hole

  double pitch_radius() const { return 0.5 * module * teeth; }
  double base_radius() const;  ///< radius of the circle that the involute unwinds from
  double tip_radius() const { return pitch_radius() + module; }
  double root_radius() const { return pitch_radius() - (1.0 + clearance) * module; }
};

/// Outline of the wheel, counter-clockwise from the middle of the first tooth's tip at angle 0.
struct GearProfile {
  std::vector<Point2> points;  ///< points on the outline [m]
  /// Outward unit normals; at a corner of a tip the mean of both sides over the cosine of half their angle,
  /// so that an offset stays parallel to both.
  std::vector<Point2> normals;
  std::vector<int> corners;  ///< indices of the sharp corners of the tips
};
/// @param spacing  target distance between points [m]
GearProfile gear_profile(const GearSize& size, double spacing);

/// Returns the area inside the outline [m^2], in closed form; the bore is not subtracted.
double gear_area(const GearSize& size);

}  // namespace palpate::shapes
