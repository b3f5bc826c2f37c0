// Quadrature points of a shape's surface: they detect contact that the points of a body alone miss.
#include "distance/points.h"
#include "palpate/contact/obstacle.h"
#include "two_balls.h"

using namespace contact_tests;

namespace {

constexpr double kPressure = 1e4;  // [Pa/m]

ContactSpec exact_law() {
  ContactSpec out;
  out.stiffness_pa_m = kPressure;
  return out;
}

contact::ShapePoints ball_points(double radius, double spacing, int frame,
                                 std::shared_ptr<contact::MovingFrame> motion) {
  return {{contact::sphere_surface(radius, spacing), frame, std::move(motion)},
          spacing,
          [radius](const Vec3& x) { return Vec3(radius * x.normalized()); },
          Vec3::Zero()};
}

/// A soft ball of radius 1 whose vertices are nodes, and a rigid one that is a body of the State; points of
/// each have half weight.
struct BallInBall {
  SurfaceWorld soft{sphere(Vec3::Zero(), 1.0, 12)};
  int body;
  contact::ContactForce term;

  BallInBall(double radius, const Vec3& at, bool own_points = true)
      : body(add_rigid_body(soft.state, Pose{quaternion_of(Vec3(0.3, -0.2, 0.5)), at}, {})) {
    const Points rest = sphere(Vec3::Zero(), 1.0, 12).vertices;
    const auto frame = contact::block_frame(body);
    term.add_frame(frame);
    auto of_soft = contact::make_sphere_source(contact::material_points(soft.surface, rest, {}, 0.1), 0,
                                               frame, Vec3::Zero(), radius, 0.1);
    if (!own_points) {
      term.add_pair(std::move(of_soft), exact_law());
    } else {
      term.add_pair(
          contact::make_half_and_half(
              std::move(of_soft),
              contact::make_distance_source(soft.surface, rest, ball_points(radius, 0.2 * radius, 0, frame),
                                            {.candidate_gap = 0.1})),
          exact_law());
    }
    term.refresh(soft.state.view());
  }
  VecX forces() { return force(term, soft.state); }
  Vec3 on_body(const VecX& f) { return f.segment<3>(soft.state.layout().find(body)->u_offset + 3); }
  Vec3 moment_on_body(const VecX& f) { return f.segment<3>(soft.state.layout().find(body)->u_offset); }
};

}  // namespace

// Archimedes: for a sphere in a half-space at depth delta, the integral of the depth over its surface is pi R
// delta^2. The remaining error is of second order, a fourth per size; sizes are integer divisions of an
// icosahedron's edges.
TEST(ShapePoints, OfABallInAHalfSpaceHaveArchimedesForce) {
  constexpr double kRadius = 1.0, kDepth = 0.3;
  TriMesh block = mesh::box_surface(Vec3(6.0, 6.0, 6.0), {1, 1, 1});
  block.vertices.row(2).array() -= 3.0;
  const dynamics::State nothing;
  double before = 0.0;
  for (const double spacing : {0.3, 0.15, 0.075}) {
    const auto source = contact::make_distance_source(
        contact::FrameSurface{block, 0, contact::fixed_frame()},
        ball_points(kRadius, spacing, 1,
                    contact::fixed_frame({Quat::Identity(), {0.1, 0.2, kRadius - kDepth}})),
        contact::DistanceOptions{});
    std::vector<contact::ContactSample> samples;
    source->query(nothing.view(), samples);
    Vec3 sum = Vec3::Zero();
    for (const contact::ContactSample& s : samples) sum -= std::max(-s.gap, 0.0) * s.area * s.normal;
    const double law = std::numbers::pi * kRadius * kDepth * kDepth, error = std::abs(sum.z() / law - 1.0);
    EXPECT_LT(sum.head<2>().norm(), 1e-3 * law);
    EXPECT_LT(error, 0.1 * spacing * spacing);
    if (before > 0.0) { EXPECT_LT(error, before / 3.0); }
    before = error;
  }
}

TEST(ShapePoints, ForceIsTheGradientOfTheEnergyOfBothHalves) {
  BallInBall balls(0.4, Vec3(0.2, 0.5, 0.7));
  const VecX f = balls.forces();
  ASSERT_GT(balls.on_body(f).norm(), 1.0);
  std::mt19937 random(3);
  for (int k = 0; k < 5; ++k) {
    VecX d(f.size());
    for (auto& x : d) x = uniform(random);
    const double h = 1e-6;
    const auto energy = [&](double s) {
      const dynamics::State at = moved(balls.soft.state, d, s);
      return balls.term.energy(at.view());
    };
    EXPECT_NEAR((energy(h) - energy(-h)) / (2.0 * h), -f.dot(d), 1e-6 * f.norm()) << k;
  }
}

TEST(ShapePoints, OfABallHaveNoMomentAboutItsCentre) {
  BallInBall balls(0.4, Vec3(0.2, 0.5, 0.7));
  const VecX f = balls.forces();
  EXPECT_LT(balls.moment_on_body(f).norm(), 1e-14 * balls.on_body(f).norm());
}

// A sphere of radius r within a sphere of radius 1, with distance c between the centres: each of its points x
// is pushed out by k/2 of 1 - |x|. The reference integral uses an independent quadrature rule.
TEST(ShapePoints, PushOutWhatLiesWithin) {
  constexpr double kSmall = 0.1, kFrom = 0.5;
  BallInBall alone(kSmall, Vec3(0.0, 0.0, kFrom), false), both(kSmall, Vec3(0.0, 0.0, kFrom));
  EXPECT_EQ(alone.on_body(alone.forces()), Vec3(Vec3::Zero()));
  double law = 0.0;
  constexpr int kParts = 1000;
  for (int i = 0; i < kParts; ++i) {
    const double z = -1.0 + 2.0 * (i + 0.5) / kParts;  // equal areas
    const Vec3 x(kSmall * std::sqrt(1.0 - z * z), 0.0, kFrom + kSmall * z);
    law += 0.5 * kPressure * (1.0 - x.norm()) * x.normalized().z() * 4.0 * std::numbers::pi * kSmall *
           kSmall / kParts;
  }
  const Vec3 pushed = both.on_body(both.forces());
  EXPECT_NEAR(pushed.z() / law, 1.0, 0.02);  // the soft ball has 20 12^2 flat faces
  EXPECT_LT(pushed.head<2>().norm(), 0.01 * law);
}
