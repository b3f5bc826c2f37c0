#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <sstream>
#include <string>

#include "loop/registries.h"
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

/// Scenes in several units, and comparisons of their results.
namespace palpate::units_scenes {

struct Units {
  const char* name;
  double length, mass;
  double force() const { return mass * length; }
  double moment() const { return force() * length; }
  double stress() const { return mass / length; }
};

inline const Units kUnits[] = {
    {"metres", 1.0, 1.0}, {"millimetres", 1e3, 1e-3}, {"kilometres", 1e-3, 1e-3}, {"small", 1e-3, 1e-9}};
inline const Units kBinaryUnits[] = {{"metres", 1.0, 1.0},
                                     {"about millimetres", 0x1p10, 0x1p-10},
                                     {"about kilometres", 0x1p-10, 0x1p-10},
                                     {"about 1000 times smaller", 0x1p-10, 0x1p-30}};

inline std::string number(double x) { return fmt::format("{:.17e}", x); }
inline std::string vec(double unit, const Vec3& x) {
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
inline std::string used_by(const std::string& integrator, const std::string& lines) {
  const auto& entry = find(loop::steppers(), integrator, "integrator");
  std::istringstream in(lines);
  std::string out;
  for (std::string line; std::getline(in, line);)
    for (const PartKey& key : entry.keys)
      if (line.starts_with(key.name + " =")) out += line + "\n";
  return out;
}

inline std::string text_of(const Scene& s, const Units& u) {
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

inline Result result_of(const Scene& s, const Units& units) {
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

inline constexpr double kRelative = 1e-6;

inline void expect_same(const VecX& a, const VecX& b, double rounding, const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  if (a.size() == 0) return;
  EXPECT_LE((a - b).cwiseAbs().maxCoeff(), kRelative * a.cwiseAbs().maxCoeff() + rounding) << what;
}

/// @param counts  whether the numbers of steps and failures must be equal as well
inline void expect_same_in_all_units(const Scene& s, const Units (&all)[4] = kUnits, bool counts = true) {
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

/// A beam that swings under gravity from an initial velocity.
inline Scene swinging(const std::string& integrator) {
  Scene s;
  s.integrator = integrator;
  s.young = 5e4;
  s.damping = 1e-3;
  s.gravity = Vec3(0, 0.5, -2);
  s.velocity = Vec3(0, 0.1, 0);
  return s;
}

}  // namespace palpate::units_scenes
