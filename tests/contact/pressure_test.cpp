#include "palpate/contact/pressure.h"

#include "fixture.h"

using namespace contact_tests;

namespace {
ContactSpec spec(const std::string& law) {
  ContactSpec s;
  s.first = "ball";
  s.second = "floor";
  s.law = law;
  s.stiffness_pa_m = 2e6;
  s.damping_pa_s_m = 300.0;
  s.hunt_crossley_s_m = 0.8;
  return s;
}
}  // namespace

TEST(Pressure, KelvinVoigtByHand) {
  // depth 1 mm, closing at 0.5 m/s: 2e6 * 1e-3 + 300 * 0.5 = 2150 Pa
  const auto p = contact::pressure(spec("kelvin_voigt"), -1e-3, -0.5);
  EXPECT_DOUBLE_EQ(p.p, 2150.0);
  EXPECT_DOUBLE_EQ(p.energy_density, 1.0);
  EXPECT_EQ(p.dp_dgap, -2e6);
  EXPECT_EQ(p.dp_drate, -300.0);
}

TEST(Pressure, HuntCrossleyByHand) {
  // 2e6 * 1e-3 * (1 + 1.5 * 0.8 * 0.5) = 3200 Pa
  const auto p = contact::pressure(spec("hunt_crossley"), -1e-3, -0.5);
  EXPECT_NEAR(p.p, 3200.0, 1e-9);
  EXPECT_NEAR(p.dp_dgap, -3.2e6, 1e-6);
  EXPECT_NEAR(p.dp_drate, -2400.0, 1e-9);
}

TEST(Pressure, NeverPullsAndIsZeroApart) {
  int cut = 0;
  for (const char* law : {"kelvin_voigt", "hunt_crossley"}) {
    for (int i = -20; i <= 20; ++i)
      for (int j = -20; j <= 20; ++j) {
        const double gap = 1e-4 * i, rate = 0.5 * j;
        const auto p = contact::pressure(spec(law), gap, rate);
        EXPECT_GE(p.p, 0.0);
        if (gap >= 0.0) {
          EXPECT_EQ(p.p, 0.0);
          EXPECT_EQ(p.energy_density, 0.0);
        } else if (p.p == 0.0) {
          ++cut;
        }
      }
  }
  EXPECT_GT(cut, 100);  // including separation fast enough to cut the damper off
}

TEST(Pressure, DerivativesAreThoseOfTheFormula) {
  int checked = 0;
  for (const char* law : {"kelvin_voigt", "hunt_crossley"}) {
    const double gap = -7e-4, rate = 0.21, h = 1e-3;
    const auto at = [&](double g, double r) { return contact::pressure(spec(law), g, r).p; };
    // Both laws are linear in gap and in rate separately, so central differences are exact to rounding.
    const auto p = contact::pressure(spec(law), gap, rate);
    EXPECT_NEAR((at(gap + 1e-4, rate) - at(gap - 1e-4, rate)) / 2e-4, p.dp_dgap, 1e-6 * std::abs(p.dp_dgap));
    EXPECT_NEAR((at(gap, rate + h) - at(gap, rate - h)) / (2 * h), p.dp_drate, 1e-6 * std::abs(p.dp_drate));
    ++checked;
  }
  EXPECT_EQ(checked, 2);
}

TEST(Onset, ByHand) {
  // k = 2e6, w = 1 mm. At half of w: k d^2/(2 w) = 2e6 * 2.5e-7/2e-3 = 250 Pa, half the slope; at 3 mm: k (3
  // - 0.5) mm = 5000 Pa.
  ContactSpec s = spec("kelvin_voigt");
  s.damping_pa_s_m = 0.0;
  s.onset_width_m = 1e-3;
  auto p = contact::pressure(s, -5e-4, 0.0);
  EXPECT_NEAR(p.p, 250.0, 1e-9);
  EXPECT_NEAR(p.dp_dgap, -1e6, 1e-6);
  EXPECT_NEAR(p.energy_density, 2e6 * 1.25e-10 / 6e-3, 1e-12);
  p = contact::pressure(s, -3e-3, 0.0);
  EXPECT_NEAR(p.p, 5000.0, 1e-9);
  EXPECT_NEAR(p.dp_dgap, -2e6, 1e-6);
}

// Pressure and its derivatives are continuous, at first touch and at the end of the onset; without an onset
// the derivative jumps.
TEST(Onset, PressureAndItsDerivativesAreContinuous) {
  int checked = 0;
  for (const char* law : {"kelvin_voigt", "hunt_crossley"})
    for (const double rate : {-0.4, 0.0, 0.05}) {
      ContactSpec s = spec(law);
      s.onset_width_m = 1e-3;
      const double slope = 2e6 * 2.0;  // upper bound of the derivative by depth
      for (const double depth : {0.0, 1e-3}) {
        const double e = 1e-9;
        const auto below = contact::pressure(s, -(depth - e), rate),
                   above = contact::pressure(s, -(depth + e), rate);
        EXPECT_NEAR(below.p, above.p, 2 * e * slope) << law;
        // a damper that grows with depth changes the slope of the pressure at the end of the onset, in
        // proportion to the rate
        if (depth == 0.0 || rate == 0.0) {
          EXPECT_NEAR(below.dp_dgap, above.dp_dgap,
                      std::abs(rate) * spec(law).damping_pa_s_m / 1e-3 * (law[0] == 'k') + 1e-4 * slope)
              << law << " " << depth;
        }
        EXPECT_NEAR(below.dp_drate, above.dp_drate, 1e-4 * 300.0) << law;
        ++checked;
      }
    }
  EXPECT_EQ(checked, 12);
  ContactSpec sharp = spec("kelvin_voigt");
  EXPECT_GT(contact::pressure(sharp, 1e-9, 0.0).dp_dgap - contact::pressure(sharp, -1e-9, 0.0).dp_dgap, 1e6);
}

TEST(Onset, DerivativesByTaylor) {
  int checked = 0;
  for (const char* law : {"kelvin_voigt", "hunt_crossley"})
    for (const double depth : {2e-4, 6e-4, 2e-3})
      for (const double rate : {-0.3, 0.1}) {
        ContactSpec s = spec(law);
        s.onset_width_m = 1e-3;
        const auto p = contact::pressure(s, -depth, rate);
        ASSERT_GT(p.p, 0.0);
        const VecX df = VecX::Constant(1, p.dp_dgap * 1e-4 + p.dp_drate * 0.05);
        expect_derivative(
            [&](double h) {
              return VecX(VecX::Constant(1, contact::pressure(s, -depth + h * 1e-4, rate + h * 0.05).p));
            },
            df, 1.0, law);
        ++checked;
      }
  EXPECT_EQ(checked, 12);
}

TEST(Onset, EnergyIsTheIntegralOfTheSpring) {
  ContactSpec s = spec("kelvin_voigt");
  s.damping_pa_s_m = 0.0;
  s.onset_width_m = 1e-3;
  // Simpson's rule is exact on each of the two polynomials.
  const auto p = [&](double depth) { return contact::pressure(s, -depth, 0.0).p; };
  const auto simpson = [&](double a, double b) { return (b - a) / 6 * (p(a) + 4 * p(0.5 * (a + b)) + p(b)); };
  const double e1 = contact::pressure(s, -1e-3, 0.0).energy_density,
               e2 = contact::pressure(s, -4e-3, 0.0).energy_density;
  EXPECT_NEAR(e1, simpson(0.0, 1e-3), 1e-14);
  EXPECT_NEAR(e2, simpson(0.0, 1e-3) + simpson(1e-3, 4e-3), 1e-12);
}

// _w - p_0| <= k w/2 (plus the damper's part, which is fully active from w on): linear in w.
TEST(Onset, TheSharpLawIsItsLimit) {
  for (const char* law : {"kelvin_voigt", "hunt_crossley"}) {
    ContactSpec s = spec(law);
    const double sharp = contact::pressure(s, -1e-3, -0.2).p;
    double before = 0.0;
    for (const double w : {4e-4, 2e-4, 1e-4}) {
      s.onset_width_m = w;
      const double difference = std::abs(contact::pressure(s, -1e-3, -0.2).p - sharp);
      EXPECT_GT(difference, 0.0);
      if (before == 0.0) before = 2.0 * difference;
      EXPECT_NEAR(before / difference, 2.0, 1e-6) << law;
      before = difference;
    }
    s.onset_width_m = 0.0;
    EXPECT_EQ(contact::pressure(s, -1e-3, -0.2).p, sharp);
  }
}

TEST(Pressure, BadValuesAreRefusedByName) {
  const auto refused = [](auto change, const std::string& expected) {
    ContactSpec s = spec("kelvin_voigt");
    change(s);
    try {
      contact::pressure(s, -1e-3, 0.0);
      ADD_FAILURE() << "accepted: " << expected;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(expected), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("\"ball\" with \"floor\""), std::string::npos) << e.what();
    }
  };
  refused([](ContactSpec& s) { s.stiffness_pa_m = 0.0; }, "stiffness_pa_m = 0 must be positive");
  refused([](ContactSpec& s) { s.stiffness_pa_m = std::nan(""); }, "stiffness_pa_m = nan");
  refused([](ContactSpec& s) { s.damping_pa_s_m = -1.0; }, "damping_pa_s_m = -1 must not be negative");
  refused([](ContactSpec& s) { s.hunt_crossley_s_m = -2.0; }, "hunt_crossley_s_m = -2");
  refused([](ContactSpec& s) { s.onset_width_m = -1e-3; }, "onset_width_m = -0.001 must not be negative");
  refused([](ContactSpec& s) { s.friction = -0.1; }, "friction = -0.1");
  refused([](ContactSpec& s) { s.friction_regularisation_m_s = -1.0; },
          "friction_regularisation_m_s = -1 must not be negative");
  refused([](ContactSpec& s) { s.law = "kelvin"; },
          "unknown law \"kelvin\" (did you mean \"kelvin_voigt\"?)");
}
