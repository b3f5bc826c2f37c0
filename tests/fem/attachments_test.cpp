#include "palpate/fem/attachments.h"

#include "fem_fixture.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

namespace {

/// A frame that rotates about a fixed tilted axis with angle(t) = a t^2 + b t and whose origin moves on a
/// parabola.
dynamics::PathPoint turning(double t) {
  const Vec3 axis = Vec3(1, 2, -1).normalized();
  const double a = 0.7, b = 1.3;
  dynamics::PathPoint p;
  p.pose.rotation = quaternion_of((a * t * t + b * t) * axis);
  p.pose.translation = Vec3(0.1 * t, 0.2 * t * t, 1.0);
  p.twist.angular = (2 * a * t + b) * axis;
  p.twist.linear = Vec3(0.1, 0.4 * t, 0);
  p.acceleration.angular = 2 * a * axis;
  p.acceleration.linear = Vec3(0, 0.4, 0);
  return p;
}

struct Motion {
  VecX x, v, a;
  Motion(const dynamics::DrivenMotion& motion, double t) {
    dynamics::State state;
    state.set_time(t);
    motion.evaluate(state.view(), x, v, a);
  }
};

}  // namespace

TEST(Attachments, NodesInABoxBordersIncluded) {
  Points p(3, 3);
  p.col(0) = Vec3(0, 0, 0);
  p.col(1) = Vec3(1, 1, 1);
  p.col(2) = Vec3(1, 1, 1.001);
  EXPECT_EQ(nodes_in_box(p, Vec3::Zero(), Vec3::Ones()), (std::vector<int>{0, 1}));
  expect_contains(message_of([&] { nodes_in_box(p, Vec3(0, 2, 0), Vec3::Ones()); }),
                  "attachment: box_min_m[1] = 2 must not exceed box_max_m[1] = 1");
}

// A block of 0.1 m, rotated, far from the origin, and stored in single precision: its top lies on the
// border of the box to about 1e-8 m, and so does its distance from the sphere's centre.
TEST(Attachments, NodesOnTheBorderAreInsideWhateverTheirRounding) {
  Points p(3, 8);
  for (int i = 0; i < 8; ++i)
    p.col(i) = Vec3(0.1 * (i & 1), 0.1 * (i >> 1 & 1), 0.1 * (i >> 2)).cast<float>().cast<double>();
  const Points one = p.colwise() + Vec3(7.3, -2.1, 0.2);
  EXPECT_EQ(nodes_in_box(one, Vec3(7.3, -2.1, 0.3), Vec3(7.4, -2.0, 0.3)), (std::vector<int>{4, 5, 6, 7}));
  EXPECT_EQ(nodes_in_sphere(one, Vec3(7.3, -2.1, 0.2), 0.1), (std::vector<int>{0, 1, 2, 4}));
  const Points small = 1e-3 * one;
  EXPECT_EQ(nodes_in_box(small, 1e-3 * Vec3(7.3, -2.1, 0.3), 1e-3 * Vec3(7.4, -2.0, 0.3)).size(), 4u);
  EXPECT_TRUE(nodes_in_box(one, Vec3(7.3, -2.1, 0.300001), Vec3(7.4, -2.0, 0.31)).empty());
}

TEST(Attachments, DirectionsOfNodesByAxis) {
  EXPECT_EQ(dofs_of_nodes({4, 1}, 10, "zx"), (std::vector<int>{33, 35, 42, 44}));
  expect_contains(message_of([] { dofs_of_nodes({0}, 0, "xw"); }),
                  "attachment: axes = \"xw\" must contain each of x, y, z at most once");
  expect_contains(message_of([] { dofs_of_nodes({0}, 0, "xx"); }), "axes = \"xx\"");
  expect_contains(message_of([] { dofs_of_nodes({0}, 0, ""); }), "holds nothing");
}

TEST(Attachments, FixedStaysWhereItIs) {
  const auto fixed = make_fixed({1, 5}, Eigen::Vector2d(0.3, -0.2));
  EXPECT_EQ(fixed->dofs(), (std::vector<int>{1, 5}));
  EXPECT_EQ(fixed->master_block(), -1);
  const Motion m(*fixed, 3.0);
  EXPECT_EQ(m.x, Eigen::Vector2d(0.3, -0.2));
  EXPECT_EQ(m.v, Eigen::Vector2d::Zero());
  EXPECT_EQ(m.a, Eigen::Vector2d::Zero());
}

TEST(Attachments, DrivenVelocityAndAccelerationAreTheDerivativesOfItsPosition) {
  const std::vector<int> dofs{0, 1, 2, 4, 9};
  const Points local = unflat(Random(61).vector(15));
  const auto driven = make_driven(dofs, local, turning);
  const double t = 0.4;
  const Motion m(*driven, t);
  for (std::size_t i = 0; i < dofs.size(); ++i)
    EXPECT_NEAR(m.x[static_cast<Eigen::Index>(i)],
                (turning(t).pose * Vec3(local.col(static_cast<Eigen::Index>(i))))[dofs[i] % 3], 1e-15);
  expect_slope_two([&](double h) { return Motion(*driven, t + h).x; }, m.v, 0.05, "velocity");
  expect_slope_two([&](double h) { return Motion(*driven, t + h).v; }, m.a, 0.05, "acceleration");
}

TEST(Attachments, RefuseDisorderedDirectionsAndMissingPaths) {
  expect_contains(message_of([] {
                    make_fixed({1, 0}, VecX::Zero(2));
                  }),
                  "directions must be strictly ascending");
  expect_contains(message_of([] {
                    make_fixed({1, 1}, VecX::Zero(2));
                  }),
                  "directions must be strictly ascending");
  expect_contains(message_of([] { make_fixed({-1, 1}, VecX::Zero(2)); }), "direction -1");
  expect_contains(message_of([] { make_fixed({0, 1}, VecX::Zero(3)); }), "2 directions and 3 values");
  expect_contains(message_of([] { make_fixed({0}, VecX::Constant(1, std::nan(""))); }), "not finite");
  expect_contains(message_of([] { make_driven({0}, Points::Zero(3, 2), turning); }),
                  "1 directions and 2 values");
  expect_contains(message_of([] { make_driven({0}, Points::Zero(3, 1), dynamics::Path()); }), "need a path");
}
