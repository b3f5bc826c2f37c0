#include <gtest/gtest.h>

#include <random>

#include "tool_fixtures.h"

using namespace palpate;
using namespace palpate::tool;
using namespace palpate::tool::testing;

namespace {

constexpr double kTick = 1e-3;

/// Returns whether a small distance from a resting handle remains small.
bool stays_bounded(const std::string& scheme, double k, double b) {
  ToolSpec spec = spec_for(scheme);
  spec.coupling.stiffness_n_m = k;
  spec.coupling.damping_n_s_m = b;
  Tool tool(spec, Vec3::Zero());
  tool.set_state(0.0, {Quat::Identity(), Vec3(1e-6, 0, 0)}, {});
  for (int i = 0; i < 3000; ++i) {
    if (!tool.advance(kTick, held({}), {}).ok()) return false;
    if (tool.pose().translation.norm() > 1e-3) return false;
  }
  return true;
}

}  // namespace

// z^2 - (2 - (h^2 k + h b)/m) z + 1 - h b/m = 0 has a root on the unit circle at z = -1: k = 4 m/h^2 - 2 b/h.
TEST(ToolStability, limit_of_semi_implicit_euler) {
  const double m = spec_for("semi-implicit-euler").mass_kg;
  for (double b : {0.0, 10.0, 40.0}) {
    double low = 1e4, high = 1e6;
    while (high / low > 1.002) {
      const double k = std::sqrt(low * high);
      (stays_bounded("semi-implicit-euler", k, b) ? low : high) = k;
    }
    const double exact = 4 * m / (kTick * kTick) - 2 * b / kTick;
    EXPECT_NEAR(low / exact, 1.0, 0.02) << "b = " << b;
  }
}

TEST(ToolStability, linearly_implicit_euler_has_no_limit) {
  for (double k : {1e2, 1e5, 1e8, 1e12})
    for (double b : {0.0, 2.0}) EXPECT_TRUE(stays_bounded("linearly-implicit-euler", k, b)) << k;
}

// For any stiffness, tick and initial state, rotated by up to nearly pi, with and without damping, against a
// stiff wall: the tool ends at rest on its target. Per tick the method dissipates (w h)^2/2 of an oscillation
// for small w h, and nearly all for large w h: 0.1 <= w h <= 1e4 here.
TEST(ToolStability, linearly_implicit_euler_settles_from_anywhere) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vec = [&] { return Vec3(uniform(rng), uniform(rng), uniform(rng)); };
  const auto wh_squared = [&] { return std::pow(10.0, 3 + 5 * uniform(rng)); };
  for (int run = 0; run < 40; ++run) {
    ToolSpec spec = spec_for("linearly-implicit-euler");
    const double h = std::pow(10.0, -3 + uniform(rng));
    spec.coupling.stiffness_n_m = wh_squared() * spec.mass_kg / (h * h);
    spec.coupling.rotational_stiffness_n_m_rad = wh_squared() * spec.inertia_kg_m2.maxCoeff() / (h * h);
    spec.coupling.damping_n_s_m = run % 2 ? 0.0 : 1.0;
    spec.coupling.rotational_damping_n_m_s_rad = run % 2 ? 0.0 : 1e-4;
    Tool tool(spec, Vec3::Zero());
    tool.set_state(0.0, {quaternion_of(3.0 * std::abs(uniform(rng)) * vec().normalized()), vec()},
                   {100.0 * vec(), 10.0 * vec()});
    for (int i = 0; i < 4000; ++i) ASSERT_TRUE(tool.advance(h, held({}), wall(1e8)).ok());
    EXPECT_LT(tool.kinetic_energy(), 1e-12) << run;
    EXPECT_LT(pose_difference(Pose{}, tool.pose()).norm(), 1e-6) << run;
  }
}

// w1 . I w1 = w1 . I w0: the gyroscopic step never adds energy, at 1 rad per tick and far beyond; an explicit
// step diverges.
class FreeSpin : public ::testing::TestWithParam<const char*> {};
TEST_P(FreeSpin, never_gains_energy) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (double spin : {1.0, 100.0, 1000.0, 1e4}) {
    ToolSpec spec = spec_for(GetParam());
    spec.inertia_kg_m2 = Vec3(1e-5, 4e-5, 4.9e-5);
    spec.coupling.rotational_stiffness_n_m_rad = spec.coupling.rotational_damping_n_m_s_rad = 0.0;
    Tool tool(spec, Vec3::Zero());
    tool.set_state(0.0, {},
                   {spin * Vec3(uniform(rng), uniform(rng), uniform(rng)).normalized(), Vec3::Zero()});
    double energy = tool.kinetic_energy();
    for (int i = 0; i < 5000; ++i) {
      ASSERT_TRUE(tool.advance(kTick, held({}), {}).ok());
      ASSERT_LE(tool.kinetic_energy(), energy * (1 + 1e-12)) << spin << " tick " << i;
      energy = tool.kinetic_energy();
    }
    EXPECT_GT(energy, 0.0);
  }
}
INSTANTIATE_TEST_SUITE_P(FixedTicks, FreeSpin,
                         ::testing::Values("linearly-implicit-euler", "semi-implicit-euler"));

// A handle thrown by a metre and spun at 1000 rad/s: the tool remains finite and bounded by the handle's
// motion.
TEST(ToolStability, a_thrown_handle_stays_finite) {
  for (const auto& info : tool_integrators()) {
    if (info.name == "simbody-cpodes") continue;  // minutes: 1000 rad/s at 1e-10
    Tool tool(spec_for(info.name), Vec3::Zero());
    const Vec3 axis = Vec3(1, -2, 0.5).normalized();
    const int ticks = info.name == "simbody-semi-explicit-euler2" ? 30 : 300;  // thousands of steps per tick
    for (int i = 0; i < ticks; ++i) {
      const Pose p0{quaternion_of(1.0 * i * axis), i < ticks / 3 ? Vec3(0, 0, 0) : Vec3(1, 0, 0)};
      const Pose p1{quaternion_of(1.0 * (i + 1) * axis), i < ticks / 3 - 1 ? Vec3(0, 0, 0) : Vec3(1, 0, 0)};
      const Twist spin{1000.0 * axis, Vec3::Zero()};
      const auto result = tool.advance(kTick, {p0, p1, spin, spin}, {});
      ASSERT_TRUE(result.ok()) << info.name << ": " << result.message;
      ASSERT_LT(tool.pose().translation.norm(), 3.0) << info.name;
      ASSERT_LT(tool.twist().angular.norm(), 1e5) << info.name;
    }
  }
}
