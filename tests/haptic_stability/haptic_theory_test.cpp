#include "haptic_stability/haptic_theory.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "haptic_stability/z_width.h"
#include "palpate/core/error.h"
#include "palpate/device/profile.h"
#include "palpate/loop/run.h"

using namespace palpate;
using namespace palpate::haptic_stability;

namespace {

/// Returns a loop with the coupling as a virtual wall.
OneAxisLoop wall(double stiffness, double damping, double device_damping = 0.1, int delay_ticks = 0) {
  OneAxisLoop loop;
  loop.tool_held = true;
  loop.coupling_stiffness_n_m = stiffness;
  loop.coupling_damping_n_s_m = damping;
  loop.device.damping_n_s_m = device_damping;
  loop.delay_ticks = delay_ticks;
  return loop;
}

/// Transfer function of b, m under a zero-order hold, (g1 z + g0)/((z - 1)(z - a)).
struct HeldMass {
  double a, g1, g0;
  HeldMass(double m, double b, double T)
      : a(std::exp(-b * T / m)), g1((T - m / b * (1.0 - a)) / b), g0((m / b * (1.0 - a) - a * T) / b) {}
};

}  // namespace

// Without damping and delay the matrix [1 - KT^2/2m, T; -KT/m, 1] has the determinant 1 + K T^2/2m > 1.
TEST(HapticTheory, no_stiffness_is_stable_without_damping) {
  int complex_pairs = 0;
  for (double K = 1.0; K < 1e5; K *= 3.0) {
    const OneAxisLoop loop = wall(K, 0.0, 0.0);
    const double per_m = K * loop.tick_s * loop.tick_s / loop.device.mass_kg;
    EXPECT_FALSE(is_stable(loop)) << K;
    if (per_m > 16.0) continue;  // Real roots.
    EXPECT_NEAR(spectral_radius(loop), std::sqrt(1.0 + 0.5 * per_m), 1e-9) << K;
    ++complex_pairs;
  }
  EXPECT_GT(complex_pairs, 8);
  EXPECT_EQ(spectral_stiffness(wall(1.0, 0.0, 0.0), 0.0), 0.0);
}

// z^2 + (K g1 - 1 - a) z + a + K g0: the roots reach the unit circle at a + K g0 = 1, or at z = -1, where
// 2 (1 + a) = K (g1 - g0).
TEST(HapticTheory, largest_stiffness_of_a_damped_mass) {
  for (const double b : {0.01, 0.1, 1.0, 10.0, 100.0, 300.0}) {
    const OneAxisLoop loop = wall(1.0, 0.0, b);
    const HeldMass G(loop.device.mass_kg, b, loop.tick_s);
    double exact = (1.0 - G.a) / G.g0;
    if (G.g1 > G.g0) exact = std::min(exact, 2.0 * (1.0 + G.a) / (G.g1 - G.g0));
    EXPECT_NEAR(spectral_stiffness(loop, 0.0) / exact, 1.0, 1e-6) << b;
  }
}

// With damping and delay: z^(1+n) (z - 1)(z - a) + ((K + B/T) z - B/T)(g1 z + g0) = 0.
TEST(HapticTheory, radius_is_that_of_the_characteristic_polynomial) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-1.0, 1.0);
  int stable = 0, unstable = 0;
  for (int i = 0; i < 300; ++i) {
    const int n = i % 4;
    const OneAxisLoop loop = wall(300.0 * std::pow(30.0, exponent(random)), std::pow(30.0, exponent(random)),
                                  std::pow(10.0, exponent(random)), n);
    const double T = loop.tick_s, K = loop.coupling_stiffness_n_m, B = loop.coupling_damping_n_s_m;
    const HeldMass G(loop.device.mass_kg, loop.device.damping_n_s_m, T);
    const int degree = n + 3;
    VecX c = VecX::Zero(degree + 1);  // Ascending powers.
    c[n + 3] += 1.0, c[n + 2] -= 1.0 + G.a, c[n + 1] += G.a;
    c[2] += (K + B / T) * G.g1, c[1] += (K + B / T) * G.g0 - B / T * G.g1, c[0] -= B / T * G.g0;
    MatX companion = MatX::Zero(degree, degree);
    companion.diagonal(-1).setOnes();
    companion.col(degree - 1) = -c.head(degree);
    const double radius = Eigen::EigenSolver<MatX>(companion, false).eigenvalues().cwiseAbs().maxCoeff();
    EXPECT_NEAR(spectral_radius(loop), radius, 1e-7 * radius) << i;
    ++(radius < 1.0 ? stable : unstable);
  }
  EXPECT_GT(stable, 30);
  EXPECT_GT(unstable, 30);
}

// The delay bound omits terms of O((b + B) t/m).
TEST(HapticTheory, delay_bound_is_the_limit_of_small_damping) {
  for (const int n : {0, 1, 3}) {
    double coarse = 0.0;
    for (const double scale : {1.0, 0.1, 0.01}) {
      OneAxisLoop loop = wall(1.0, 0.0, scale, n);
      const double B = 2.0 * scale;
      loop.device.mass_kg = 1.0;
      const double error = std::abs(spectral_stiffness(loop, B) / delay_bound_stiffness(loop, B) - 1.0);
      EXPECT_LT(error, 4.0 * (0.5 + n) * loop.tick_s * 3.0 * scale) << n << " " << scale;
      if (coarse > 0.0) { EXPECT_NEAR(coarse / error, 10.0, 0.5) << n << " " << scale; }
      coarse = error;
    }
  }
}

TEST(HapticTheory, passive_lies_within_stable_whatever_arm_holds_it) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int checked = 0;
  for (int i = 0; i < 400; ++i) {
    const double b = std::pow(10.0, 3.0 * unit(random) - 2.0);
    OneAxisLoop loop = wall(1.0, b * (2.0 * unit(random) - 1.0), b, i % 3);
    if (i % 2) {
      loop.device.arm_mass_kg = 2.0 * unit(random);
      loop.device.arm_damping_n_s_m = 5.0 * unit(random);
      loop.device.arm_stiffness_n_m = 1e4 * unit(random);
    }
    loop.coupling_stiffness_n_m = 0.999 * passive_stiffness(loop, loop.coupling_damping_n_s_m);
    ASSERT_TRUE(is_passive(loop));
    EXPECT_TRUE(is_stable(loop)) << i << ": radius " << spectral_radius(loop);
    loop.coupling_stiffness_n_m *= 1.01;
    EXPECT_FALSE(is_passive(loop));
    ++checked;
  }
  EXPECT_EQ(checked, 400);
}

// A rigidly held handle leaves the tool's limit, 4 m/h^2 - 2 b/h, and none for the implicit scheme.
TEST(HapticTheory, tool_under_a_heavy_device_has_the_limit_of_its_scheme) {
  OneAxisLoop loop;
  loop.device.mass_kg = 1e5;
  loop.device.damping_n_s_m = 1e6;
  loop.tool_integrator = "semi-implicit-euler";
  for (const double b : {4.0, 40.0})
    EXPECT_NEAR(spectral_stiffness(loop, b) / (4.0 * loop.tool_mass_kg / 1e-6 - 2.0 * b / 1e-3), 1.0, 1e-3)
        << b;
  loop.tool_integrator = "linearly-implicit-euler";
  loop.coupling_stiffness_n_m = 1e6;
  EXPECT_TRUE(is_stable(loop));
  loop.tool_integrator = "simbody-rkmerson";
  EXPECT_THROW(loop_matrix(loop), Error);
}

TEST(ZWidth, says_when_passive_lies_outside_of_stable) {
  ZWidth z;
  z.rows = {{.damping = 0.0, .passive = 190.0, .spectral = 200.0, .simulated = 199.0}};
  EXPECT_TRUE(z.passive_within_stable());
  EXPECT_NEAR(z.largest_difference(), 0.005, 1e-12);
  z.rows[0].simulated = 180.0;
  EXPECT_FALSE(z.passive_within_stable());
  z.rows[0].simulated = 199.0;
  z.fine = {{.damping = 0.0, .passive = 201.0, .spectral = 200.0}};
  EXPECT_FALSE(z.passive_within_stable());
}

// A ball of 10 mm: patches of 1 and 10 mm; k pi a^2 in series with 2 E a/(1 - nu^2).
TEST(ZWidth, estimates_contacts_from_the_scene) {
  scene::Description d;
  d.name = "two sides";
  d.tool.emplace();
  d.bodies.resize(1);
  d.bodies[0].name = "soft";
  d.bodies[0].youngs_modulus_pa = 1e4;
  d.bodies[0].poissons_ratio = 0.0;
  d.contacts.resize(2);
  d.contacts[0] = {.first = "soft", .second = "tool", .stiffness_pa_m = 1e7 / M_PI};
  d.contacts[1] = {
      .first = "tool", .second = "floor", .stiffness_pa_m = 2e7 / M_PI, .damping_pa_s_m = 1e4 / M_PI};
  const ToolContactRange range = contact_range(d);
  EXPECT_NEAR(range.least.stiffness, 1.0 / (1.0 / 10.0 + 1.0 / 20.0), 1e-9);
  EXPECT_NEAR(range.greatest.stiffness, 2000.0, 1e-9);
  EXPECT_NEAR(range.greatest.damping, 1.0, 1e-12);
  d.contacts[0].spring = "per_point";
  EXPECT_THROW(contact_range(d), Error);
  d.contacts.clear();
  EXPECT_THROW(contact_range(d), Error);
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  EXPECT_THROW(loop_of(d), Error);
  d.tool.reset();
  EXPECT_THROW(loop_of(d), Error);
}

#ifdef PALPATE_HAS_TOOL
// A ball of 100 g and 10 mm has 2/5 m r^2 = 4e-6 kg m^2 about any axis. Under a held handle semi-implicit
// Euler is stable below k = 4 I/h^2 - 2 b/h, in theory and in the simulation of its ticks.
TEST(RotationalLoop, has_the_limit_of_the_tools_scheme_in_its_own_units) {
  scene::Description d;
  d.tool.emplace();
  d.tool->integrator = "semi-implicit-euler";
  d.device.emplace();
  d.device->profile = "omni";  // Has no torque output.
  const ToolContactRange range{{100.0, 1.0}, {1000.0, 2.0}};
  const RotationalLoop rotation = rotational_loop_of(d, loop_of(d), range);
  EXPECT_NEAR(rotation.inertia_kg_m2, 4e-6, 1e-12);
  EXPECT_FALSE(rotation.driven);
  const double a2 = rotation.lever_m * rotation.lever_m;
  EXPECT_NEAR(a2 * rotation.loop.tool_mass_kg, 4e-6, 1e-12);
  EXPECT_NEAR(a2 * rotation.loop.coupling_stiffness_n_m, 0.3, 1e-12);
  EXPECT_NEAR(a2 * rotation.loop.coupling_damping_n_s_m, 1e-3, 1e-15);
  EXPECT_NEAR(a2 * rotation.range.greatest.stiffness, 1000.0 * 1e-4, 1e-12) << "at the tool's radius";
  EXPECT_NEAR(a2 * rotation.range.least.stiffness, 100.0 * 1e-6 / 4.0, 1e-12) << "a disc of a tenth of it";
  const double limit = 4.0 * 4e-6 / 1e-6 - 2.0 * 1e-3 / 1e-3;
  EXPECT_NEAR(a2 * spectral_stiffness(rotation.loop, rotation.loop.coupling_damping_n_s_m) / limit, 1.0,
              1e-3);
  for (const double share : {0.97, 1.03}) {
    d.tool->coupling.rotational_stiffness_n_m_rad = share * limit;
    const RotationalLoop near = rotational_loop_of(d, loop_of(d), range);
    const OperatingPoint air = operating_points(near.loop, near.range, 4.0).front();
    EXPECT_EQ(air.simulated_stable, share < 1.0) << share;
    EXPECT_EQ(air.radius <= 1.0 + 1e-9, share < 1.0) << share;
    if (share > 1.0) {
      EXPECT_NE(air.words(1e-3, a2, "N m/rad").find("is above 14 N m/rad"), std::string::npos)
          << air.words(1e-3, a2, "N m/rad");
    }
  }
}

TEST(RotationalLoop, takes_the_hand_s_own_figures) {
  scene::Description d;
  d.tool.emplace();
  d.tool->inertia_kg_m2 = Vec3(3e-5, 1e-5, 2e-5);
  d.device.emplace();
  d.device->type = "hand";
  d.device->rotational_inertia_kg_m2 = 2e-3;
  d.device->arm_rotational_damping_n_m_s_rad = 0.05;
  d.device->arm_rotational_stiffness_n_m_rad = 3.0;
  const RotationalLoop rotation = rotational_loop_of(d, loop_of(d), {{1.0, 0.0}, {1.0, 0.0}});
  const double a2 = rotation.lever_m * rotation.lever_m;
  EXPECT_TRUE(rotation.driven);
  EXPECT_NEAR(rotation.inertia_kg_m2, 1e-5, 1e-11) << "the least: the first to vibrate";
  EXPECT_NEAR(a2 * rotation.loop.device.total_mass(), 2e-3, 1e-12);
  EXPECT_NEAR(a2 * rotation.loop.device.total_damping(), 0.05, 1e-12);
  EXPECT_NEAR(a2 * rotation.loop.device.arm_stiffness_n_m, 3.0, 1e-12);
  EXPECT_EQ(rotation.loop.device.damping_n_s_m, 0.0);
}

TEST(ZWidth, simulated_and_exact_walls_are_the_same) {
  ZWidthOptions options;
  options.rows = 5;
  const ZWidth z = z_width(OneAxisLoop{}, options);
  EXPECT_EQ(z.rows.size(), 5u);
  EXPECT_TRUE(z.passive_within_stable());
  EXPECT_GT(z.rows[0].passive, 0.0);
  EXPECT_LT(z.largest_difference(), 0.02);
}

TEST(ZWidth, verdicts_on_a_scene_s_own_loop) {
  OneAxisLoop loop;
  const ToolContactRange range{{10.0, 0.0}, {1000.0, 0.0}};
  auto points = operating_points(loop, range, 4.0);
  ASSERT_EQ(points.size(), 3u);
  for (const OperatingPoint& p : points) {
    EXPECT_TRUE(p.simulated_stable) << p.name;
    EXPECT_NE(p.words(loop.tick_s).find("let go, but not passive: some hand"), std::string::npos) << p.name;
  }
  EXPECT_NEAR(points[2].series, 1000.0 * 300.0 / 1300.0, 1e-9);
  OneAxisLoop in_arm = loop;
  in_arm.device.arm_stiffness_n_m = 500.0;
  in_arm.device.arm_damping_n_s_m = 5.0;
  EXPECT_NE(operating_points(in_arm, range, 1.0)[0].words(loop.tick_s).find("held so, but not"),
            std::string::npos);
  loop.tool_integrator = "semi-implicit-euler";
  loop.coupling_stiffness_n_m = 1e6;
  points = operating_points(loop, range, 4.0);
  for (const OperatingPoint& p : points) {
    EXPECT_FALSE(p.simulated_stable) << p.name;
    EXPECT_NE(p.words(loop.tick_s).find("unstable"), std::string::npos) << p.name;
  }
}

namespace {

/// Computes both limits, and checks that they agree to 2 %.
void expect_same_limit(const OneAxisLoop& loop, double damping, const std::string& what) {
  const double theory = spectral_stiffness(loop, damping), found = simulated_stiffness(loop, damping, 4.0);
  ASSERT_TRUE(std::isfinite(theory) && theory > 0.0) << what;
  EXPECT_NEAR(found / theory, 1.0, 0.02) << what << ": " << theory << " N/m";
}

}  // namespace

TEST(HapticSimulation, finds_the_largest_wall_of_theory) {
  for (const int n : {0, 1, 2})
    for (const double B : {0.0, 1.0, 5.0})
      expect_same_limit(wall(1.0, B, 0.1, n), B, fmt::format("delay {}, B {}", n, B));
  OneAxisLoop held = wall(1.0, 0.0);
  held.device.arm_mass_kg = 0.8;
  held.device.arm_damping_n_s_m = 5.5;
  held.device.arm_stiffness_n_m = 568.0;
  expect_same_limit(held, 2.0, "arm");
}

TEST(HapticSimulation, finds_the_largest_coupling_of_a_tool_pressed_on_a_one_sided_wall) {
  for (const char* scheme : {"linearly-implicit-euler", "semi-implicit-euler"})
    for (const double K : {1e3, 1e4}) {
      OneAxisLoop loop;
      loop.tool_integrator = scheme;
      loop.contact_stiffness_n_m = K;
      loop.contact_damping_n_s_m = 1.0;
      expect_same_limit(loop, 2.0, fmt::format("{}, contact {} N/m", scheme, K));
    }
}
#endif
