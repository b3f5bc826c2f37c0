#include <limits>

#include "cases.h"
#include "e_oscillator.h"

// The handle jumps by a shift along, and a turn below pi about, a principal axis of the tool, and rests.
// Along and about that axis nothing couples:
// the distance from the handle is m y'' + b y' + k y = 0 and I a'' + b_r a' + k_r a = 0, released at rest.

namespace palpate::validation {
namespace {

constexpr double kShift = 0.01, kTurn = 2.5;  // [m], [rad]

/// Largest relative deviation from `exact(oscillator, y0, tick number)` over the ticks: turn, shift, and both
/// at the last tick.
struct Deviation {
  double turn = 0, shift = 0, last_turn = 0, last_shift = 0;
};

template <class Exact>
Deviation deviation(const std::string& scheme, const std::string& fault, int axis, double h, int ticks,
                    Exact exact) {
  const ToolSpec spec = desktop_tool(scheme);
  const Oscillator turning{spec.inertia_kg_m2[axis], spec.coupling.rotational_damping_n_m_s_rad,
                           spec.coupling.rotational_stiffness_n_m_rad};
  const Oscillator shifting{spec.mass_kg, spec.coupling.damping_n_s_m, spec.coupling.stiffness_n_m};
  ToolSpec broken = spec;
  if (fault == "half-stiffness")
    broken.coupling.stiffness_n_m *= 0.5, broken.coupling.rotational_stiffness_n_m_rad *= 0.5;
  if (fault == "wrong-inertia-axis")
    broken.inertia_kg_m2 = Vec3(spec.inertia_kg_m2.z(), spec.inertia_kg_m2.x(), spec.inertia_kg_m2.y());
  const Vec3 e = Vec3::Unit(axis);
  const Pose there{quaternion_of(kTurn * e), kShift * e};
  tool::Tool body(broken, Vec3::Zero());
  Deviation out;
  for (int i = 1; i <= ticks; ++i) {
    const Pose before = fault == "late-handle" && i == 1 ? Pose{} : there;
    const Pose end = fault == "late-handle" && i == 1 && scheme == "linearly-implicit-euler" ? Pose{} : there;
    if (!body.advance(h, {before, end, {}, {}}, {}).ok()) return {NAN, NAN, NAN, NAN};
    const Vec6 d = pose_difference(there, body.pose());
    out.last_turn = std::abs(d.head<3>().dot(e) - exact(turning, -kTurn, i)) / kTurn;
    out.last_shift = std::abs(d.tail<3>().dot(e) - exact(shifting, -kShift, i)) / kShift;
    out.turn = std::max(out.turn, out.last_turn);
    out.shift = std::max(out.shift, out.last_shift);
  }
  return out;
}

void measure_error_controlled(const std::string& scheme, const std::string& fault,
                              std::vector<Measurement>& out) {
  constexpr double h = 1e-3;
  const auto d = deviation(scheme, fault, 1, h, 100,
                           [](const Oscillator& o, double y0, int i) { return o.at_time(y0, h * i); });
  out.push_back({.quantity = scheme + ": shift against the closed form, / shift",
                 .computed = d.shift,
                 .error = d.shift,
                 .bar = 1e-6});
  out.push_back({.quantity = scheme + ": turn about the middle axis, / turn",
                 .computed = d.turn,
                 .error = d.turn,
                 .bar = 1e-6});
}

void measure_fixed(const std::string& scheme, const std::string& fault, std::vector<Measurement>& out) {
  double turn = 0, shift = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto d = deviation(scheme, fault, axis, 1e-3, 200, [&](const Oscillator& o, double y0, int i) {
      return o.after_ticks(scheme, y0, 1e-3, i);
    });
    turn = std::max(turn, d.turn), shift = std::max(shift, d.shift);
  }
  out.push_back({.quantity = scheme + ": shift against its discrete closed form",
                 .computed = shift,
                 .error = shift,
                 .bar = 1e-10});
  out.push_back({.quantity = scheme + ": turn against its discrete closed form",
                 .computed = turn,
                 .error = turn,
                 .bar = 1e-10});

  constexpr double kEnd = 0.02;
  std::vector<double> ticks, turns, shifts;
  for (double h : {2e-4, 1e-4, 5e-5, 2.5e-5}) {
    const auto d = deviation(scheme, fault, 2, h, static_cast<int>(std::lround(kEnd / h)),
                             [&](const Oscillator& o, double y0, int i) { return o.at_time(y0, h * i); });
    ticks.push_back(h), turns.push_back(d.last_turn), shifts.push_back(d.last_shift);
  }
  const auto first_order = [&](const std::string& what, const std::vector<double>& e) {
    out.push_back({.quantity = scheme + ": " + what + " at 20 ms, finest tick",
                   .computed = e.back(),
                   .error = e.back(),
                   .bar = 1e-2,
                   .order = validation::fitted_order(ticks, e),
                   .order_low = 0.9,
                   .order_high = 1.1,
                   .note = "ticks 200 to 25 us"});
  };
  first_order("shift", shifts);
  first_order("turn", turns);
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  for (const char* scheme : {"simbody-rkmerson", "simbody-cpodes"})
    measure_error_controlled(scheme, fault, out);
  for (const char* scheme : {"linearly-implicit-euler", "semi-implicit-euler"})
    measure_fixed(scheme, fault, out);
  return out;
}

}  // namespace

ValidationCase handle_step() {
  return {.name = "handle-step",
          .section = "E",
          .summary = "the tool follows a jump of the handle: damped oscillator, in time and in ticks",
          .why =
              "what a user feels of the coupling is this response; a fixed tick must be off by its own "
              "closed form and by nothing else",
          .run = run,
          .faults = {"half-stiffness", "wrong-inertia-axis", "late-handle"}};
}

}  // namespace palpate::validation
