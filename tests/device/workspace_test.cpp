#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "palpate/device/device.h"
#include "palpate/device/limiter.h"
#include "palpate/device/profile.h"
#include "palpate/device/registry.h"
#include "palpate/device/workspace.h"

using namespace palpate;
using namespace palpate::device;

TEST(Workspace, distances_to_box_ball_and_both) {
  const Vec3 c(1, 2, 3);
  const Workspace box{c, Vec3(0.2, 0.4, 0.6), 0.0, 0.01}, ball{c, Vec3::Zero(), 0.1, 0.01};
  EXPECT_EQ(Workspace{}.distance_outside(Vec3(1e9, 0, 0)), 0.0);
  EXPECT_EQ(box.distance_outside(c + Vec3(0.09, -0.19, 0.29)), 0.0);
  EXPECT_NEAR(box.distance_outside(c + Vec3(0.13, -0.24, 0.0)), 0.05, 1e-15);  // 3-4-5 triangle from an edge
  EXPECT_EQ(ball.distance_outside(c + Vec3(0.05, 0.05, 0.05)), 0.0);
  EXPECT_NEAR(ball.distance_outside(c + Vec3(0, 0, -0.13)), 0.03, 1e-15);
  const Workspace both{c, Vec3(0.2, 0.4, 0.6), 0.15, 0.01};
  EXPECT_NEAR(both.distance_outside(c + Vec3(0, 0, 0.25)), 0.1, 1e-15);
}

TEST(Workspace, share_fades_smoothly) {
  const Workspace ball{Vec3::Zero(), Vec3::Zero(), 0.1, 0.01};
  const auto share = [&](double r) { return ball.share(Vec3(0, r, 0)); };
  EXPECT_EQ(share(0.0999), 1.0);
  EXPECT_NEAR(share(0.105), 0.5, 1e-12);
  EXPECT_NEAR(share(0.1025), 1.0 - 10.0 / 64.0, 1e-12);  // 1 - x^2 (3 - 2 x) at x = 1/4
  EXPECT_EQ(share(0.11), 0.0);
  EXPECT_EQ(share(5.0), 0.0);
  const double h = 1e-7;  // C1 at both ends
  EXPECT_NEAR((share(0.1 + h) - share(0.1 - h)) / (2 * h), 0.0, 1e-2);
  EXPECT_NEAR((share(0.11 + h) - share(0.11 - h)) / (2 * h), 0.0, 1e-2);
  EXPECT_EQ(ball.share(Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0)), 0.0);
  EXPECT_EQ(Workspace{}.share(Vec3(1e9, 0, 0)), 1.0);
}

// Same order of calls as the loop: sample, then limit.
TEST(Workspace, the_limiter_fades_the_force_of_a_handle_that_leaves_it) {
  DeviceSpec spec;
  spec.keyframes = {{0.0, Vec3::Zero(), Vec3::Zero(), Interpolation::kLinear},
                    {1.0, Vec3(0.2, 0, 0), Vec3::Zero(), Interpolation::kLinear}};
  spec.workspace_radius_m = 0.1;
  spec.workspace_margin_m = 0.05;
  const auto device = make_device(spec);
  const DeviceFigures figures = figures_of(spec);
  WrenchLimiter limiter(3.3, 0.2, 0.0), free(3.3, 0.2, 0.0);
  limiter.confine(figures.workspace, *device);
  int inside = 0, fading = 0, outside = 0;
  for (int i = 0; i <= 1000; ++i) {
    const double t = 1e-3 * i, x = device->sample(t).pose.translation.x();
    const Wrench requested{Vec3(0, 0.05, 0), Vec3(1.0, 0, 0)}, full = free.limit(t, requested, true),
                                                               out = limiter.limit(t, requested, true);
    const double share = figures.workspace.share(Vec3(x, 0, 0));
    EXPECT_NEAR(out.force.x(), share * full.force.x(), 1e-15);
    EXPECT_NEAR(out.moment.y(), share * full.moment.y(), 1e-15);
    if (x < 0.0999) {
      ++inside;
    } else if (x > 0.15) {
      EXPECT_EQ(out.force.norm() + out.moment.norm(), 0.0);
      ++outside;
    } else {
      ++fading;
    }
  }
  EXPECT_GT(std::min({inside, fading, outside}), 200);
  EXPECT_LE(std::abs(limiter.outside_ticks() - fading - outside), 3);
  EXPECT_EQ(free.outside_ticks(), 0);
}
