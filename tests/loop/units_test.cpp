#include <gtest/gtest.h>

#include <functional>
#include <sstream>

#include "loop/modes.h"
#include "loop/registries.h"
#include "palpate/linear/solvers.h"
#include "palpate/loop/load.h"
#include "palpate/loop/run.h"

// Results depend neither on units nor on the size of the simulated bodies. With the unit of time kept, let
// every length be multiplied by L and every mass by M. The equations of motion are then the same if
//
//   density M/L^3     force  M L       stiffness of a coupling      M        [N/m]
//   velocity L        moment M L^2     its damping                  M        [N s/m]
//   acceleration L    Pa     M/L       about an axis                M L^2    [N m/rad], [N m s/rad]
//   inertia M L^2     onset, gap L     contact stiffness, damping   M/L^2    [Pa/m], [Pa s/m]
//   v_r L             E, nu:  M/L, 1   Hunt and Crossley's c        1/L      [s/m]
//
// and relative tolerances, angles, friction and times are kept. Results are compared in the first units:
// every number differs only by the rounding of the numbers from which it was computed.
//   millimetres, tonnes, seconds:       L = 1e3,  M = 1e-3  (stress in MPa)
//   kilometres, tonnes, seconds:        L = 1e-3, M = 1e-3
//   metres, a body 1000 times smaller:  L = 1e-3, M = 1e-9  (density as before)
//
// Error control chooses steps from error estimates that rounding changes, and a run of hundreds of steps then
// differs by its integration error, whatever the units. With 1024 instead of 1000 nothing is rounded: every
// product and quotient scales exactly, and so must the steps.

namespace palpate {
namespace {

struct Units {
  const char* name;
  double length, mass;
  double force() const { return mass * length; }
  double moment() const { return force() * length; }
  double stress() const { return mass / length; }
};

const Units kUnits[] = {
    {"metres", 1.0, 1.0}, {"millimetres", 1e3, 1e-3}, {"kilometres", 1e-3, 1e-3}, {"small", 1e-3, 1e-9}};
const Units kBinaryUnits[] = {{"metres", 1.0, 1.0},
                              {"about millimetres", 0x1p10, 0x1p-10},
                              {"about kilometres", 0x1p-10, 0x1p-10},
                              {"about 1000 times smaller", 0x1p-10, 0x1p-30}};

std::string number(double x) { return fmt::format("{:.17e}", x); }
std::string vec(double unit, const Vec3& x) {
  return fmt::format("[{}, {}, {}]", number(unit * x.x()), number(unit * x.y()), number(unit * x.z()));
}

/// Parameters of one scene; numbers in metres, kilogrammes, seconds.
struct Scene {
  std::string integrator = "kinsol-static";
  std::string settings{};         ///< TOML; settings that the integrator does not use are left out
  std::string solver_settings{};  ///< TOML settings of the integrator's linear solver
  double duration = 0.1, young = 5e6, damping = 0.0, step = 0.01;
  Vec3 size = Vec3(0.4, 0.1, 0.1), gravity = Vec3(0, 0, -1);
  double element = 0.05;
  bool held = true;
  Vec3 position = Vec3::Zero(), velocity = Vec3::Zero();
  std::function<std::string(const Units&)> rest{};  ///< remaining TOML of the scene
};

/// Returns the lines "KEY = VALUE" whose key the integrator uses.
std::string used_by(const std::string& integrator, const std::string& lines) {
  const auto& entry = find(loop::steppers(), integrator, "integrator");
  std::istringstream in(lines);
  std::string out;
  for (std::string line; std::getline(in, line);)
    for (const PartKey& key : entry.keys)
      if (line.starts_with(key.name + " =")) out += line + "\n";
  return out;
}

std::string text_of(const Scene& s, const Units& u) {
  std::string t = fmt::format("[scene]\nname = \"scene\"\nduration_s = {}\ngravity_m_s2 = {}\n", s.duration,
                              vec(u.length, s.gravity));
  t += fmt::format("[integrator]\nname = \"{}\"\n{}{}\n[record]\nstate_period_s = {}\n", s.integrator,
                   used_by(s.integrator, fmt::format("step_s = {}\n", s.step) + s.settings),
                   s.solver_settings, s.duration);
  t += fmt::format(
      "[[body]]\nname = \"body\"\nyoungs_modulus_pa = {}\npoissons_ratio = 0.3\ndensity_kg_m3 = {}\n"
      "stiffness_damping_s = {}\nposition_m = {}\nvelocity_m_s = {}\n",
      number(s.young * u.stress()), number(1000.0 * u.mass / std::pow(u.length, 3)), s.damping,
      vec(u.length, s.position), vec(u.length, s.velocity));
  t += fmt::format("[body.mesh]\ngenerator = \"box\"\nsize_m = {}\nelement_size_m = {}\n",
                   vec(u.length, s.size), number(u.length * s.element));
  if (s.held) {
    const Vec3 half = 0.5 * s.size, some = Vec3::Constant(1e-3 * s.size.minCoeff());
    Vec3 high = half + some;
    high.x() = -half.x() + some.x();
    t += fmt::format("[[body.attachment]]\nbox_min_m = {}\nbox_max_m = {}\n",
                     vec(u.length, s.position - half - some), vec(u.length, s.position + high));
  }
  return t + (s.rest ? s.rest(u) : "");
}

/// Records the last tick of the tool.
struct LastTick final : loop::Observer {
  loop::TickRecord last;
  void tick(const loop::TickRecord& t) override { last = t; }
};

struct Result {
  VecX q, u;  ///< displacements and velocities of nodes
  VecX tool;  ///< position, contact wrench, wrench on the hand, each in its units
  dynamics::StepperCounters counters;
  std::string error;
};

Result result_of(const Scene& s, const Units& units) {
  const auto world = loop::assemble(loop::parse(text_of(s, units), "units.toml"));
  const int nodal = world->state.layout().nodal_size;
  const VecX start = world->state.q().head(nodal);
  LastTick tick;
  loop::RunOptions options;
  options.observers = {&tick};
  const loop::RunResult run = loop::run(*world, options);
  Result out;
  out.error = run.status.message;
  out.counters = run.counters;
  out.q = (world->state.q().head(nodal) - start) / units.length;
  out.u = world->state.u().head(nodal) / units.length;
  if (world->description.tool) {
    out.tool.resize(15);
    out.tool << tick.last.tool.translation / units.length, tick.last.contact.force / units.force(),
        tick.last.contact.moment / units.moment(), tick.last.requested.force / units.force(),
        tick.last.requested.moment / units.moment();
  }
  return out;
}

constexpr double kRelative = 1e-6;

void expect_same(const VecX& a, const VecX& b, double rounding, const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  if (a.size() == 0) return;
  EXPECT_LE((a - b).cwiseAbs().maxCoeff(), kRelative * a.cwiseAbs().maxCoeff() + rounding) << what;
}

/// @param counts  whether the numbers of steps and failures must be equal as well
void expect_same_in_all_units(const Scene& s, const Units (&all)[4] = kUnits, bool counts = true) {
  const Result first = result_of(s, kUnits[0]);
  ASSERT_EQ(first.error, "") << kUnits[0].name;
  EXPECT_GT(first.q.norm(), 0.0);
  for (const Units& units : all) {
    SCOPED_TRACE(units.name);
    const Result other = result_of(s, units);
    ASSERT_EQ(other.error, "");
    expect_same(first.q, other.q, 0.0, "displacements");
    expect_same(first.u, other.u, 0.0, "velocities");
    for (int part = 0; part < first.tool.size() / 3; ++part)
      expect_same(first.tool.segment<3>(3 * part), other.tool.segment<3>(3 * part), 0.0,
                  fmt::format("tool, part {}", part));
    if (!counts) continue;
    EXPECT_EQ(first.counters.steps, other.counters.steps);
    EXPECT_EQ(first.counters.newton_failures, other.counters.newton_failures);
    EXPECT_EQ(first.counters.events, other.counters.events);
    EXPECT_EQ(first.counters.projected, other.counters.projected);
    EXPECT_EQ(first.counters.unconverged, other.counters.unconverged);
  }
}

// --- Statics

/// Linear displacement of the beam: one solve with the initial tangent.
VecX linear_response(const Scene& s, const Units& units) {
  const auto world = loop::assemble(loop::parse(text_of(s, units), "units.toml"));
  VecX f, x;
  world->system.force(world->state.view(), f);
  world->system.reduce(world->state.view(), f);
  dynamics::BorderedMatrix K;
  world->system.step_matrix(world->state.view(), 0.0, 0.0, 1.0, K);
  const auto solver = linear::make_linear_solver("cholmod");
  EXPECT_EQ(solver->factor(K), dynamics::SolveStatus::kOk);
  EXPECT_EQ(solver->solve(f, x), dynamics::SolveStatus::kOk);
  return x / units.length;
}

// Twelve decades of gravity, from loads at which rotations matter to loads at which a displacement is
// 1e-14 of the beam. A node's position has a rounding error of eps times its magnitude, 0.2 m, and a force
// one of eps |K||x|, which moves the slender beam by about ten times more: this limits the comparison of
// displacements.
TEST(Units, EquilibriaFollowTheLoadOverTwelveDecades) {
  for (const Units& units : kUnits) {
    const double rounding = 100.0 * std::numeric_limits<double>::epsilon() * 0.2;
    for (int decade = 0; decade <= 12; ++decade) {
      SCOPED_TRACE(fmt::format("{}, gravity 1e{}", units.name, 2 - decade));
      Scene s;
      s.gravity = Vec3(0, 0, -std::pow(10.0, 2 - decade));
      const Result found = result_of(s, units);
      ASSERT_EQ(found.error, "");
      EXPECT_LE(found.counters.solver.factorisations, 10);
      EXPECT_EQ(found.counters.newton_failures, 0);
      if (decade >= 5) { EXPECT_GT(found.counters.rounding_limited, 0); }
      const VecX linear = linear_response(s, units);
      // the nonlinear part decreases with the load: 1e-3 of the displacement for the first load
      const double bent = linear.cwiseAbs().maxCoeff() / s.size.x();
      EXPECT_LE((found.q - linear).cwiseAbs().maxCoeff(),
                std::max(kRelative, bent) * linear.cwiseAbs().maxCoeff() + rounding);
    }
  }
}

TEST(Units, LargeBendingUnderADeadLoad) {
  Scene s;
  s.young = 1e5;
  s.gravity = Vec3(0, 0, -2);
  expect_same_in_all_units(s);
}

// --- Fixed steps

Scene swinging(const std::string& integrator) {
  Scene s;
  s.integrator = integrator;
  s.young = 5e4;
  s.damping = 1e-3;
  s.gravity = Vec3(0, 0.5, -2);
  s.velocity = Vec3(0, 0.1, 0);
  return s;
}

class FixedSteps : public testing::TestWithParam<std::string> {};
TEST_P(FixedSteps, AreTheSameInAllUnits) { expect_same_in_all_units(swinging(GetParam())); }
INSTANTIATE_TEST_SUITE_P(Units, FixedSteps,
                         testing::Values("linearly-implicit-euler", "backward-euler", "implicit-midpoint",
                                         "bdf2", "newmark", "generalized-alpha"));

class LinearSolvers : public testing::TestWithParam<std::string> {};
TEST_P(LinearSolvers, AreTheSameInAllUnits) {
  Scene s = swinging("linearly-implicit-euler");
  s.settings = fmt::format("linear_solver = \"{}\"", GetParam());
  if (!find(linear::linear_solver_registry(), GetParam(), "linear solver").keys.empty())
    s.solver_settings = "linear_rtol = 1e-9";
  expect_same_in_all_units(s);
}
std::vector<std::string> linear_solvers() {
  std::vector<std::string> names;
  for (const auto& entry : linear::linear_solver_registry()) names.push_back(entry.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(Units, LinearSolvers, testing::ValuesIn(linear_solvers()));

class ExplicitSteps : public testing::TestWithParam<std::string> {};
TEST_P(ExplicitSteps, AreTheSameInAllUnits) {
  Scene s = swinging(GetParam());
  s.step = 2e-4;
  s.duration = 0.04;
  expect_same_in_all_units(s);
}
INSTANTIATE_TEST_SUITE_P(Units, ExplicitSteps, testing::Values("symplectic-euler", "rk4"));

// --- Error control

class ErrorControl : public testing::TestWithParam<std::string> {};
TEST_P(ErrorControl, IsTheSameInAllUnits) {
  Scene s = swinging(GetParam());
  s.settings = "rtol = 1e-5";
  s.duration = 0.05;
  expect_same_in_all_units(s, kBinaryUnits);
}
INSTANTIATE_TEST_SUITE_P(Units, ErrorControl,
                         testing::Values("cvode-bdf", "cvode-adams", "ida", "ark-erk-4", "ark-dirk-esdirk324",
                                         "ark-imex-3"));

// --- Contact

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

// --- Modes

TEST(Units, FrequenciesAndShapesOfModes) {
  for (const bool held : {true, false}) {
    Scene s;
    s.held = held;
    modes::Modes first;
    for (const Units& units : kUnits) {
      SCOPED_TRACE(fmt::format("{}, {}", units.name, held ? "held" : "free"));
      const auto world = loop::assemble(loop::parse(text_of(s, units), "units.toml"));
      modes::Modes found = loop::find_modes(*world, 9);
      EXPECT_TRUE(found.converged);
      if (&units == kUnits) first = found;
      ASSERT_EQ(found.count(), first.count());
      for (int j = 0; j < found.count(); ++j)
        EXPECT_NEAR(found.omega_squared[j], first.omega_squared[j], kRelative * first.omega_squared[j]) << j;
      // M-orthonormal: x M x = 1; a square section has pairs of modes, of which any rotation is equally valid
      const double size = first.shapes.leftCols(2).norm();
      if (held) {
        EXPECT_NEAR(std::sqrt(units.mass) * found.shapes.leftCols(2).norm(), size, kRelative * size);
      }
    }
  }
}

}  // namespace
}  // namespace palpate
