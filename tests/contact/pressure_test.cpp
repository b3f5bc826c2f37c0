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
  EXPECT_GT(cut, 100);  // separation fast enough to be cut was among them
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
  refused([](ContactSpec& s) { s.friction = -0.1; }, "friction = -0.1");
  refused([](ContactSpec& s) { s.friction_regularisation_m_s = 0.0; }, "friction_regularisation_m_s = 0 must be positive");
  refused([](ContactSpec& s) { s.law = "kelvin"; }, "unknown law \"kelvin\" (did you mean \"kelvin_voigt\"?)");
}
