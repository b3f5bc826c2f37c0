#include "shapes/gear_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "palpate/core/error.h"

using namespace palpate;
using shapes::GearProfile;
using shapes::GearSize;
using shapes::Point2;

namespace {

double polygon_area(const GearProfile& profile) {
  double sum = 0.0;
  for (std::size_t i = 0; i < profile.points.size(); ++i) {
    const Point2 &a = profile.points[i], &b = profile.points[(i + 1) % profile.points.size()];
    sum += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return sum;
}

// Standard diameters: pitch z m, tip (z + 2) m, root (z - 2.5) m, base z m cos 20.
TEST(GearProfile, HasTheDiametersOfItsModule) {
  const GearSize size;
  EXPECT_NEAR(2.0 * size.pitch_radius(), 0.092, 1e-12);
  EXPECT_NEAR(2.0 * size.tip_radius(), 0.100, 1e-12);
  EXPECT_NEAR(2.0 * size.root_radius(), 0.082, 1e-12);
  double least = 1.0, greatest = 0.0;
  for (const Point2& p : shapes::gear_profile(size, 1e-3).points)
    least = std::min(least, p.norm()), greatest = std::max(greatest, p.norm());
  EXPECT_NEAR(greatest, size.tip_radius(), 1e-12);
  EXPECT_NEAR(least, size.root_radius(), 1e-12);
}

// A polygon on a smooth outline has an area error of O(spacing^2): four times finer, a sixteenth of the
// error.
TEST(GearProfile, AreaTendsToItsClosedForm) {
  const GearSize size;
  const double exact = shapes::gear_area(size);
  const double coarse = polygon_area(shapes::gear_profile(size, 4e-4)) - exact,
               fine = polygon_area(shapes::gear_profile(size, 1e-4)) - exact;
  EXPECT_LT(std::abs(fine), 2e-5 * exact);
  EXPECT_GT(coarse / fine, 12.0);
  EXPECT_LT(coarse / fine, 20.0);
}

// On the pitch circle a tooth is half a pitch wide: pi m / 2. (The flank crosses it between two points;
// linear interpolation is sufficiently accurate there.)
TEST(GearProfile, ToothAndGapAreEquallyWideOnThePitchCircle) {
  const GearSize size;
  const GearProfile profile = shapes::gear_profile(size, 2e-5);
  for (std::size_t i = 0; i + 1 < profile.points.size(); ++i) {
    const double a = profile.points[i].norm(), b = profile.points[i + 1].norm(), r = size.pitch_radius();
    if (a < r || b > r) continue;
    const Point2 p = profile.points[i] + (a - r) / (a - b) * (profile.points[i + 1] - profile.points[i]);
    EXPECT_NEAR(2.0 * size.pitch_radius() * std::atan2(p.y(), p.x()), 0.5 * std::numbers::pi * size.module,
                1e-7);
    return;
  }
  FAIL() << "the flank never crosses the pitch circle";
}

// An involute's normals are tangent to the base circle: |p x n| = base radius for every point of a flank.
TEST(GearProfile, FlankNormalsTouchTheBaseCircle) {
  const GearSize size;
  const GearProfile profile = shapes::gear_profile(size, 2e-4);
  int flank = 0;
  for (std::size_t i = 0; i < profile.points.size(); ++i) {
    const Point2 &p = profile.points[i], &n = profile.normals[i];
    if (p.norm() < size.base_radius() * 1.0001 || p.norm() > size.tip_radius() * 0.9999) continue;
    EXPECT_NEAR(std::abs(p.x() * n.y() - p.y() * n.x()), size.base_radius(), 1e-9);
    ++flank;
  }
  EXPECT_GT(flank, 23 * 2 * 10);
  EXPECT_EQ(profile.corners.size(), 46U);
}

// The secant through a point's two neighbours follows the outline: it is perpendicular to the normal.
TEST(GearProfile, NormalsStandAcrossTheOutline) {
  const GearProfile profile = shapes::gear_profile({}, 1e-4);
  const std::size_t n = profile.points.size();
  int looked_at = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 along = (profile.points[(i + 1) % n] - profile.points[(i + n - 1) % n]).normalized();
    const Point2 normal = profile.normals[i].normalized();
    EXPECT_NEAR(along.dot(normal), 0.0, 0.2) << i;
    EXPECT_GT(along.x() * normal.y() - along.y() * normal.x(), -1.01);
    // counter-clockwise: the outside is on the right
    EXPECT_LT(along.x() * normal.y() - along.y() * normal.x(), -0.95) << i;
    ++looked_at;
  }
  EXPECT_GT(looked_at, 1000);
}

TEST(GearProfile, RefusesTeethThatWouldMeet) {
  GearSize size;
  size.fillet = 3.0;
  EXPECT_THROW(shapes::gear_profile(size, 1e-3), InternalError);
}

}  // namespace
