#include <limits>

#include "cases.h"
#include "e_faulty_tool.h"
#include "e_oscillator.h"

// Problem: the handle jumps by a translation along, and a rotation below pi about, a principal axis of the
// tool, and rests.
//
// Exact answer: translation along and rotation about this axis are not coupled to other motions. The distance
// from the handle satisfies
//     m y'' + b y' + k y = 0,   I a'' + b_r a' + k_r a = 0,
// released at rest (e_oscillator.h, in time and in ticks). Measured: the deviation from it over the ticks,
// limit 1e-6 for methods with error control; for fixed ticks 1e-10 from the closed form in ticks (rounding),
// and order 0.9 to 1.1 in time.

namespace palpate::validation {
namespace {

constexpr double kTranslation = 0.01, kRotation = 2.5;  // [m], [rad]

/// Largest relative deviation from `exact(oscillator, y0, tick number)` over the ticks, in rotation and in
/// translation, and both deviations at the last tick.
struct Deviation {
  double rotation = 0, translation = 0, last_rotation = 0, last_translation = 0;
};

template <class Exact>
Deviation deviation(const std::string& scheme, const std::string& fault, int axis, double h, int ticks,
                    Exact exact) {
  const ToolSpec spec = desktop_tool(scheme);
  const Oscillator rotational{spec.inertia_kg_m2[axis], spec.coupling.rotational_damping_n_m_s_rad,
                              spec.coupling.rotational_stiffness_n_m_rad};
  const Oscillator translational{spec.mass_kg, spec.coupling.damping_n_s_m, spec.coupling.stiffness_n_m};
  const Vec3 e = Vec3::Unit(axis);
  const Pose there{quaternion_of(kRotation * e), kTranslation * e};
  FaultyTool body(spec, fault);
  Deviation out;
  for (int i = 1; i <= ticks; ++i) {
    if (!body.advance(h, {there, there, {}, {}}, {}).ok()) return {NAN, NAN, NAN, NAN};
    const Vec6 d = pose_difference(there, body.pose());
    out.last_rotation = std::abs(d.head<3>().dot(e) - exact(rotational, -kRotation, i)) / kRotation;
    out.last_translation =
        std::abs(d.tail<3>().dot(e) - exact(translational, -kTranslation, i)) / kTranslation;
    out.rotation = std::max(out.rotation, out.last_rotation);
    out.translation = std::max(out.translation, out.last_translation);
  }
  return out;
}

void measure_error_controlled(const std::string& scheme, const std::string& fault,
                              std::vector<Measurement>& out) {
  constexpr double h = 1e-3;
  const auto d = deviation(scheme, fault, 1, h, 100,
                           [](const Oscillator& o, double y0, int i) { return o.at_time(y0, h * i); });
  out.push_back({.quantity = scheme + ": translation against the closed form, / distance",
                 .computed = d.translation,
                 .error = d.translation,
                 .bar = 1e-6});
  out.push_back({.quantity = scheme + ": rotation about the middle axis against the closed form, / angle",
                 .computed = d.rotation,
                 .error = d.rotation,
                 .bar = 1e-6});
}

void measure_fixed(const std::string& scheme, const std::string& fault, std::vector<Measurement>& out) {
  double rotation = 0, translation = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto d = deviation(scheme, fault, axis, 1e-3, 200, [&](const Oscillator& o, double y0, int i) {
      return o.after_ticks(scheme, y0, 1e-3, i);
    });
    rotation = std::max(rotation, d.rotation), translation = std::max(translation, d.translation);
  }
  out.push_back({.quantity = scheme + ": translation against its discrete closed form",
                 .computed = translation,
                 .error = translation,
                 .bar = 1e-10});
  out.push_back({.quantity = scheme + ": rotation against its discrete closed form",
                 .computed = rotation,
                 .error = rotation,
                 .bar = 1e-10});

  constexpr double kEnd = 0.02;
  std::vector<double> ticks, rotations, translations;
  for (double h : {2e-4, 1e-4, 5e-5, 2.5e-5}) {
    const auto d = deviation(scheme, fault, 2, h, static_cast<int>(std::lround(kEnd / h)),
                             [&](const Oscillator& o, double y0, int i) { return o.at_time(y0, h * i); });
    ticks.push_back(h), rotations.push_back(d.last_rotation), translations.push_back(d.last_translation);
  }
  const auto first_order = [&](const std::string& what, const std::vector<double>& e) {
    out.push_back({.quantity = scheme + ": " + what + " at 20 ms, finest tick",
                   .computed = e.back(),
                   .error = e.back(),
                   .bar = 1e-2,
                   .order = validation::fitted_order(ticks, e),
                   .order_low = 0.9,
                   .order_high = 1.1,
                   .note = "ticks 200 to 25 us",
                   .refinement = {"tick [s]", ticks, e}});
  };
  first_order("translation", translations);
  first_order("rotation", rotations);
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
  return {
      .name = "handle-step",
      .section = "E",
      .summary = "the tool follows a jump of the handle: damped oscillator, in time and in ticks",
      .why =
          "this is the response of the coupling that reaches the user; the error of a fixed tick must equal "
          "its discrete closed form",
      .quick = true,
      .run = run,
      .faults = {
          {"half-stiffness", "translation"}, {"axes-swapped", "rotation"}, {"late-handle", "closed form"}}};
}

}  // namespace palpate::validation
