// Balls against exact shapes: the force at unit stiffness is the volume of the overlap.
#include <numbers>

#include "rigid_sides.h"

using namespace palpate;
using namespace contact_tests;
using namespace contact_tests::rigid_sides;
using contact::ContactSample;

namespace {

/// Overlap volume by the samples: force along the normal at unit stiffness.
double volume(const std::vector<ContactSample>& samples, double deeper = 0.0) {
  double sum = 0.0;
  for (const ContactSample& s : samples) sum += s.area * std::max(0.0, deeper - s.gap);
  return sum;
}

contact::ContactSide ball_at(const Vec3& centre) {
  return contact::FrameBall{kR, Vec3::Zero(), 0, contact::fixed_frame({Quat::Identity(), centre})};
}

/// Volume between a ball and the region below height(x, y), whose highest point is 0 at the origin, with the
/// ball's lowest point `depth` below that; by the midpoint rule on a fine grid.
template <class Height>
double overlap(double depth, const Height& height) {
  constexpr int n = 1500;
  const double cell = 2.0 * kR / n;
  double sum = 0.0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double x = (i + 0.5) * cell - kR, y = (j + 0.5) * cell - kR, rest = kR * kR - x * x - y * y;
      if (rest > 0.0) sum += std::max(0.0, height(x, y) - (kR - depth) + std::sqrt(rest)) * cell * cell;
    }
  return sum;
}

}  // namespace

// Rings of samples are complete, so that the volume is exact.
TEST(BallOnPlane, ForceIsTheCapsVolume) {
  const dynamics::State state;
  for (const double depth : {1e-9, 1e-4, 0.05, 0.29, 0.3, 0.45}) {
    const auto samples = query(*on_plane(ball_at({0.4, -2.0, kR - depth}), 0.02), state);
    const double exact = depth < kR ? cap(depth) : cap(kR) + std::numbers::pi * kR * kR * (depth - kR);
    EXPECT_NEAR(volume(samples) / exact, 1.0, depth < 1e-6 ? 1e-6 : 1e-12) << depth;
  }
}

TEST(BallOnPlane, ABallThatIsApartIsACandidate) {
  const dynamics::State state;
  const auto samples = query(*on_plane(ball_at({0, 0, kR + 0.01}), 0.02), state);
  EXPECT_EQ(volume(samples), 0.0);
  EXPECT_FALSE(samples.empty());
  EXPECT_TRUE(query(*on_plane(ball_at({0, 0, kR + 0.021}), 0.02), state).empty());
  EXPECT_FALSE(query(*on_plane(ball_at({0, 0, kR + 0.037}), 0.0), state).empty())
      << "an eighth of the radius";
  EXPECT_TRUE(query(*on_plane(ball_at({0, 0, kR + 0.038}), 0.0), state).empty());
}

// pi (R1+R2-d)^2 (d^2 + 2d(R1+R2) - 3 (R1-R2)^2) / (12 d)
TEST(BallOnSphere, ForceIsTheLensVolume) {
  const dynamics::State state;
  int checked = 0;
  for (const double r : {0.05, 0.3, 2.0})
    for (const double depth : {1e-4, 0.02, 0.045}) {
      const Vec3 direction = Vec3(1, -2, 0.5).normalized(), centre(0.3, 0.1, -0.7);
      const double d = kR + r - depth;
      const auto source = contact::make_sphere_source(ball_at(centre + d * direction), 1,
                                                      contact::fixed_frame(), centre, r, 0.01);
      const double lens = std::numbers::pi * depth * depth *
                          (d * d + 2.0 * d * (kR + r) - 3.0 * (kR - r) * (kR - r)) / (12.0 * d);
      const auto samples = query(*source, state);
      EXPECT_NEAR(volume(samples) / lens, 1.0, 1e-4) << r << ", " << depth;
      for (const ContactSample& s : samples) EXPECT_LT((s.normal - direction).norm(), 1e-14);
      ++checked;
    }
  EXPECT_EQ(checked, 9);
}

TEST(BallOnBox, FaceEdgeAndCorner) {
  const dynamics::State state;
  const Pose pose{quaternion_of(Vec3(0.3, 0.2, -0.5)), Vec3(0.1, 0.2, 0.3)};
  const Vec3 size(4.0, 4.0, 2.0);
  const auto of = [&](const Vec3& corner, const Vec3& out, double depth) {
    const Vec3 centre = pose * Vec3(corner + (kR - depth) * out.normalized());
    return volume(query(
        *contact::make_box_source(ball_at(centre), 1, contact::fixed_frame(), pose, size, 0.01), state));
  };
  EXPECT_NEAR(of({0.3, 0.1, 1.0}, {0, 0, 1}, 0.05) / cap(0.05), 1.0, 1e-12);
  // an edge of 90 degrees, along its bisector
  const double edge = overlap(0.05, [](double x, double) { return -std::abs(x); });
  EXPECT_NEAR(of({2.0, 0.1, 1.0}, {1, 0, 1}, 0.05) / edge, 1.0, 5e-3);
  EXPECT_LT(edge, 0.5 * cap(0.05));
  // a corner along its diagonal: three planes of slope sqrt(2) meet there, with x along one of their edges
  const double corner = overlap(0.05, [](double x, double y) {
    double height = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double phi = 2.0 * std::numbers::pi * k / 3.0;
      height = std::min(height, std::sqrt(2.0) * (x * std::cos(phi) + y * std::sin(phi)));
    }
    return height;
  });
  EXPECT_NEAR(of({2.0, 2.0, 1.0}, {1, 1, 1}, 0.05) / corner, 1.0, 2e-2);
}

TEST(BallOnCylinder, SideAndEnd) {
  const dynamics::State state;
  const Pose pose{quaternion_of(Vec3(0.1, -0.4, 0.7)), Vec3(-0.1, 0.4, 0.2)};
  const auto of = [&](const Vec3& centre) {
    return volume(query(*contact::make_cylinder_source(ball_at(pose * centre), 1, contact::fixed_frame(),
                                                       pose, 0.5, 3.0, 0.01),
                        state));
  };
  const double side = overlap(0.05, [](double x, double) { return std::sqrt(0.25 - x * x) - 0.5; });
  EXPECT_NEAR(of(Vec3(0.6, 0.8, 0.0) * (0.5 + kR - 0.05)) / side, 1.0, 2e-3);
  EXPECT_NEAR(of({0.05, 0.0, 1.5 + kR - 0.05}) / cap(0.05), 1.0, 1e-12) << "the flat end";
}
