// Contact force along smooth paths: no jumps beyond one point's share, no work around closed loops.
#include "bodies.h"

using namespace distance_tests;

// A foot that changes from one face to another across a sharp edge changes its spring's force by at most
// twice its magnitude; all other springs change smoothly.
TEST(SmoothContact, JumpsAreBoundedByOnePointsShare) {
  Pair pair;
  const SkinContactSpec spec{
      .stiffness_pa_m = 1e6,
      .spacing_m = {0.5 * pair.a.skin.longest_edge.maxCoeff(), 0.5 * pair.b.skin.longest_edge.maxCoeff()}};
  SkinContact contact(pair.a.skin, pair.b.skin, spec);
  std::mt19937 random(19);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vec3(normal(random), normal(random), normal(random)).normalized(); };
  double worst = 0.0;
  for (int path = 0; path < 4; ++path) {
    const Vec3 way = direction(), axis = direction();
    std::vector<Vec3> force;
    double share = 0.0, largest = 0.0;
    for (int i = 0; i < 100; ++i) {
      const double s = 1e-5 * i;  // [m]
      pair.b.place(rotation(axis * (0.1 + 5 * s)) * rotation({0.3, -0.8, 0.4}),
                   Vec3(0.168, 0.01, -0.006) + s * way);
      contact.find(pair.a.at(), pair.b.at());
      force.push_back(contact.resultant().force);
      share = std::max(share, contact.largest_force() / force.back().norm());
      largest = std::max(largest, force.back().norm());
    }
    for (std::size_t i = 1; i + 1 < force.size(); ++i) {
      const double jump = (force[i + 1] - 2 * force[i] + force[i - 1]).norm() / largest;
      EXPECT_LT(jump, share);
      worst = std::max(worst, jump);
    }
    EXPECT_LT(share, 0.05);
  }
  EXPECT_GT(worst, 1e-7);  // it changes at all
  EXPECT_LT(worst, 5e-3);
}

// The error of the trapezium rule around a circle with n steps is of second order in 1/n, and larger at first
// touch; a force with a curl would leave work however small the steps are.
TEST(SmoothContact, ClosedLoopsDoNoWork) {
  Pair pair;
  SkinContact contact(pair.a.skin, pair.b.skin, {.stiffness_pa_m = 1e6});
  const Vec3 planes[3][2] = {
      {Vec3::UnitX(), Vec3::UnitY()}, {Vec3::UnitY(), Vec3::UnitZ()}, {Vec3::UnitZ(), Vec3::UnitX()}};
  for (const auto& plane : planes) {
    double work = 0.0, size = 0.0;
    Vec3 last_force, last;
    const int steps = 180;
    for (int i = 0; i <= steps; ++i) {
      const double angle = 2 * M_PI * i / steps;
      const Vec3 at =
          Vec3(0.166, 0.01, -0.006) + 0.003 * (std::cos(angle) * plane[0] + std::sin(angle) * plane[1]);
      pair.b.place(rotation({0.3, -0.8, 0.4}), at);
      contact.find(pair.a.at(), pair.b.at());
      const Vec3 force = -contact.resultant().force;
      if (i > 0) {
        work += 0.5 * (force + last_force).dot(at - last);
        size += 0.5 * (force.norm() + last_force.norm()) * (at - last).norm();
      }
      last_force = force;
      last = at;
    }
    EXPECT_GT(size, 1e-4);
    EXPECT_LT(std::abs(work), 1e-4 * size);
  }
}
