// Results of bodies in contact with planes and a tool depend neither on units nor on size (units_scenes.h).
#include <gtest/gtest.h>

#include "units_scenes.h"

namespace palpate {
namespace {

using namespace units_scenes;

struct Contact {
  std::string integrator, law, events = "error-control";
};
class OnAPlane : public testing::TestWithParam<Contact> {};
TEST_P(OnAPlane, IsTheSameInAllUnits) {
  Scene s = swinging(GetParam().integrator);
  s.held = false;
  s.size = Vec3(0.1, 0.1, 0.05);
  s.element = 0.025;
  s.position = Vec3(0, 0, 0.026);
  s.velocity = Vec3(0.05, 0, -0.2);
  s.gravity = Vec3(0, 0, -9.81);
  s.step = 2e-3;
  s.duration = 0.03;
  // under error control, contact opens and closes by rounding: the run's error is kept below the acceptance
  // limit
  const bool controlled = GetParam().integrator == "cvode-bdf";
  s.settings = fmt::format("rtol = {}\nevents = \"{}\"", controlled ? 1e-9 : 1e-5, GetParam().events);
  s.rest = [&](const Units& u) {
    const bool hunt = GetParam().law == "hunt_crossley";
    // root finding is for laws without an onset
    const double onset = GetParam().events == "root-finding" ? 0.0 : 1e-4;
    return "[[obstacle]]\nname = \"floor\"\ntype = \"plane\"\n[[contact]]\nbetween = [\"body\", "
           "\"floor\"]\n" +
           fmt::format(
               "stiffness_pa_m = {}\nlaw = \"{}\"\n{} = {}\nonset_width_m = {}\ncandidate_gap_m = {}\n"
               "friction = 0.3\nfriction_regularisation_m_s = {}\n",
               number(1e7 * u.stress() / u.length), GetParam().law,
               hunt ? "hunt_crossley_s_m" : "damping_pa_s_m",
               number(hunt ? 0.5 / u.length : 1e4 * u.stress() / u.length), number(onset * u.length),
               number(0.02 * u.length), number(1e-3 * u.length));
  };
  expect_same_in_all_units(s, kBinaryUnits, !controlled);
}
INSTANTIATE_TEST_SUITE_P(Units, OnAPlane,
                         testing::Values(Contact{"linearly-implicit-euler", "kelvin_voigt"},
                                         Contact{"linearly-implicit-euler", "hunt_crossley"},
                                         Contact{"rk4", "hunt_crossley"}),
                         [](const auto& row) { return fmt::format("Row{}", row.index); });
INSTANTIATE_TEST_SUITE_P(UnderErrorControl, OnAPlane,
                         testing::Values(Contact{"cvode-bdf", "kelvin_voigt"},
                                         Contact{"cvode-bdf", "hunt_crossley", "root-finding"}),
                         [](const auto& row) { return fmt::format("Row{}", row.index); });

// The mesh determines the gap for candidates; nothing slides.
TEST(Units, RestOnAPlane) {
  Scene s;
  s.held = false;
  s.size = Vec3(0.1, 0.1, 0.05);
  s.element = 0.025;
  s.young = 5e4;
  s.position = Vec3(0, 0, 0.0249);
  s.gravity = Vec3(0, 0, -9.81);
  s.rest = [](const Units& u) {
    return "[[obstacle]]\nname = \"floor\"\ntype = \"plane\"\n[[contact]]\nbetween = [\"body\", "
           "\"floor\"]\n" +
           fmt::format(
               "stiffness_pa_m = {}\n[[body.attachment]]\nbox_min_m = {}\nbox_max_m = {}\naxes = \"xy\"\n",
               number(1e7 * u.stress() / u.length), vec(u.length, Vec3::Constant(-1)),
               vec(u.length, Vec3::Constant(1)));
  };
  expect_same_in_all_units(s);
}

// --- A tool on a spring and a damper
#ifdef PALPATE_HAS_TOOL
struct Coupling {
  std::string integrator, scheme, linearisation;
};
class PressedByATool : public testing::TestWithParam<Coupling> {};
TEST_P(PressedByATool, IsTheSameInAllUnits) {
  Scene s = swinging(GetParam().integrator);
  s.size = Vec3(0.1, 0.06, 0.04);
  s.element = 0.02;
  s.young = 2e4;
  s.damping = 2e-3;
  s.gravity = Vec3(0, 0, -9.81);
  s.velocity = Vec3::Zero();
  const bool controlled = GetParam().integrator == "cvode-bdf";
  s.settings = controlled ? "rtol = 1e-9" : "rtol = 1e-5";
  s.duration = 0.05;
  s.rest = [&](const Units& u) {
    const Vec3 above(0.02, 0.005, 0.02 + 0.015 - 0.002);
    std::string t = fmt::format(
        "[tool]\nshape = \"sphere\"\nradius_m = {}\nmass_kg = {}\nposition_m = {}\n[tool.coupling]\n"
        "stiffness_n_m = {}\ndamping_n_s_m = {}\nrotational_stiffness_n_m_rad = {}\n"
        "rotational_damping_n_m_s_rad = {}\n",
        number(0.015 * u.length), number(0.05 * u.mass), vec(u.length, above), number(300 * u.mass),
        number(4 * u.mass), number(0.3 * u.mass * u.length * u.length),
        number(1e-3 * u.mass * u.length * u.length));
    t += fmt::format(
        "[device]\ntype = \"script\"\nmax_force_n = {}\nmax_torque_n_m = {}\n[[device.keyframe]]\n"
        "time_s = 0.0\nposition_m = {}\n[[device.keyframe]]\ntime_s = 0.1\nposition_m = {}\n",
        number(3.3 * u.force()), number(1.0 * u.moment()), vec(u.length, above),
        vec(u.length, above - Vec3(0, 0.01, 0.01)));
    t += fmt::format(
        "[[contact]]\nbetween = [\"body\", \"tool\"]\nmethod = \"analytic\"\nstiffness_pa_m = "
        "{}\ndamping_pa_s_m = {}\n"
        "friction = 0.3\nfriction_regularisation_m_s = {}\n",
        number(1e7 * u.stress() / u.length), number(1e3 * u.stress() / u.length), number(0.01 * u.length));
    return t +
           fmt::format("[exchange]\nscheme = \"{}\"\n{}exchange_period_s = 0.01\ncontact_refresh_s = 0.01\n",
                       GetParam().scheme,
                       GetParam().linearisation.empty()
                           ? ""
                           : fmt::format("linearisation = \"{}\"\n", GetParam().linearisation));
  };
  expect_same_in_all_units(s, kBinaryUnits, !controlled);
}
INSTANTIATE_TEST_SUITE_P(Units, PressedByATool,
                         testing::Values(Coupling{"linearly-implicit-euler", "partitioned", "points"},
                                         Coupling{"linearly-implicit-euler", "partitioned", "condensed"},
                                         Coupling{"linearly-implicit-euler", "partitioned", "frozen"},
                                         Coupling{"linearly-implicit-euler", "monolithic", ""},
                                         Coupling{"cvode-bdf", "monolithic", ""}),
                         [](const auto& row) { return fmt::format("Row{}", row.index); });
#endif

}  // namespace
}  // namespace palpate
