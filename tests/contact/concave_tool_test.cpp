// A ball against a ring, inside its hole and outside of it, by nearest points: force and moment against the
// integrals of the law. With c the ball's centre, at distance x from the ring's axis and in its plane, the
// points of both skins count with half weight, each with its depth in the other body, per area of its skin:
//   ball   d = r - |(rho - R, z)|,   rho the distance from the axis     (R the ring's radius, r its tube's)
//   ring   d = 1 - |p - c|
//   U = k/4 (int d+^2 dA over the ball + int d+^2 dA over the ring),   F = -dU/dx along x.
#include <gtest/gtest.h>

#include "contact/sources.h"
#include "proxy/tools.h"
#include "surfaces.h"

using namespace contact_tests;

namespace {

constexpr double kRing = 2.0, kTube = 0.4, kDepth = 0.06;

/// 4 U/k at x [m^4], by the midpoint rule.
double energy(double x) {
  constexpr int kParts = 1500;
  double sum = 0.0;
  for (int i = 0; i < kParts; ++i) {
    const double v = -1.0 + 2.0 * (i + 0.5) / kParts;  // the ball's surface by height and angle: equal areas
    for (int j = 0; j < kParts; ++j) {
      const double phi = 2.0 * kPi * (j + 0.5) / kParts, across = std::sqrt(1.0 - v * v);
      const double rho = std::hypot(x + across * std::cos(phi), across * std::sin(phi)),
                   d = kTube - std::hypot(rho - kRing, v);
      if (d > 0.0) sum += d * d * 4.0 * kPi / (kParts * kParts);
    }
  }
  for (int i = 0; i < kParts; ++i) {
    const double theta = 2.0 * kPi * (i + 0.5) / kParts, rho = kRing + kTube * std::cos(theta),
                 z = kTube * std::sin(theta);
    for (int j = 0; j < kParts; ++j) {
      const double phi = 2.0 * kPi * (j + 0.5) / kParts;
      const double d = 1.0 - Vec3(rho * std::cos(phi) - x, rho * std::sin(phi), z).norm();
      if (d > 0.0) sum += d * d * kTube * rho * 4.0 * kPi * kPi / (kParts * kParts);
    }
  }
  return sum;
}

}  // namespace

TEST(ConcaveTool, FeelsTheForceOfTheLaw) {
  // Sagittae of 4e-4 at a depth of 0.06: the force is accurate to 1 %.
  const TriMesh ring = tools::torus(kRing, kTube, 320, 120), ball = mesh::sphere(1.0, 40);
  for (const double x : {kRing - kTube - 1.0 + kDepth, kRing + kTube + 1.0 - kDepth}) {
    SCOPED_TRACE(x);
    const Pose pose{Quat(0.8, 0.2, -0.5, 0.3).normalized(), Vec3(0.4, -2.0, 1.0)};
    TriMesh placed = ball;
    for (auto p : placed.vertices.colwise()) p = pose * Vec3(p + Vec3(x, 0, 0));
    SurfaceWorld world(placed);
    contact::ContactForce term;
    const auto frame = contact::fixed_frame(pose);
    term.add_frame(frame);
    ContactSpec law;
    law.stiffness_pa_m = 1.0;
    term.add_pair(
        contact::make_distance_source(world.surface, ball.vertices, contact::FrameSurface{ring, 0, frame},
                                      {.quadrature_error = 1e-3}),
        law);
    term.refresh(world.state.view());
    const Wrench on_ring = term.frame_wrench(world.state.view(), 0);
    const Vec3 force = pose.rotation.conjugate() * Vec3(-on_ring.force),
               moment = pose.rotation.conjugate() * Vec3(on_ring.moment);
    constexpr double kStep = 1e-3;
    const double exact = -0.25 * (energy(x + kStep) - energy(x - kStep)) / (2.0 * kStep);
    EXPECT_NEAR(force.x() / exact, 1.0, 0.02) << exact;
    EXPECT_LT(std::hypot(force.y(), force.z()), 2e-3 * std::abs(exact));
    EXPECT_LT(moment.norm(), 2e-3 * std::abs(exact)) << "the line of force goes through the axis";
  }
}
