#pragma once
#include "palpate/contact/spec.h"

namespace palpate::contact {

/// Pressure p(gap, gap_rate) [Pa] and its derivatives. p >= 0 always (no adhesion), and p = 0 for gap >= 0.
/// With the depth delta = -gap > 0, its rate delta' = -gap_rate, and the onset function s(delta) =
/// delta^2/(2w) for delta < w and delta - w/2 beyond (s = delta for w = 0):
///   kelvin_voigt   p = max(0, k s + d s' delta')
///   hunt_crossley  p = max(0, k s (1 + 3/2 c delta'))      (Hunt and Crossley 1975)
/// With w > 0 the spring, and all of hunt_crossley, is C1 in depth and rate. The damper of kelvin_voigt then
/// sets in without a jump, but with a kink: its slope with respect to depth at first touch is d delta'/w.
/// Where the pressure is cut off during separation it is continuous, with a kink. `energy_density` is the
/// energy of the spring, k times the integral of s [J/m^2].
struct Pressure {
  /// p [Pa], its derivatives with respect to gap [Pa/m] and gap rate [Pa s/m], and the spring's energy
  /// density [J/m^2].
  double p, dp_dgap, dp_drate, energy_density;
};

/// Pressure law of a ContactSpec, with its names resolved.
struct PressureLaw {
  /// Laws of damping.
  enum class Kind { kKelvinVoigt, kHuntCrossley };
  Kind kind = Kind::kKelvinVoigt;  ///< Law of this contact.
  double k = 0.0;                  ///< Stiffness [Pa/m]; per point [N/m].
  double d = 0.0;                  ///< Damping [Pa s/m]; per point [N s/m]; or c of hunt_crossley [s/m].
  double onset = 0.0;              ///< w [m]
  double friction = 0.0;           ///< mu [-].
  double regularisation = 1e-3;    ///< v_r [m/s].
  double retardation = 0.0;        ///< tau of the friction springs [s]; 0: none.
  /// True: step matrices omit the derivative of friction with respect to pressure (sample_math.cpp).
  bool symmetric_tangent = false;
  /// True: springs per point instead of per area: `Pressure::p` is a force [N], and the area of every sample
  /// is 1.
  bool per_point = false;
  /// True: the derivative of friction with respect to velocity is its secant through zero (sample_math.cpp).
  bool secant_friction = false;
};

/// Resolves and checks the contact law of a spec. @throws Error for an invalid value, with the pair and the
/// key
PressureLaw pressure_law(const ContactSpec& spec);

/// s(delta) with its derivative and its integral from 0.
struct Onset {
  double value;     ///< s(delta) [m].
  double slope;     ///< Derivative s'(delta) [-].
  double integral;  ///< Integral of s from 0 to delta [m^2].
};
/// Evaluates the onset function of a width [m] at a depth [m]: a parabola that joins the line delta - w/2
/// with equal value w/2 and slope 1 at delta = w. Its integral is delta^3/(6 w) up to w, w^2/6 there, and
/// delta^2/2 - w delta/2 + w^2/6 beyond.
inline Onset onset(double width, double depth) {
  if (!(depth > 0.0)) return {0.0, 0.0, 0.0};
  if (depth < width)
    return {0.5 * depth * depth / width, depth / width, depth * depth * depth / (6.0 * width)};
  return {depth - 0.5 * width, 1.0, 0.5 * depth * (depth - width) + width * width / 6.0};
}

// With delta = -gap, delta' = -gap_rate, so dp/dgap = -dp/ddelta and dp/drate = -dp/ddelta'; s'' = 1/w up to
// w, 0 beyond:
//   kelvin_voigt   dp/ddelta = k s' + d s'' delta'       dp/ddelta' = d s'
//   hunt_crossley  dp/ddelta = k s' (1 + 3/2 c delta')   dp/ddelta' = 3/2 k c s
// The damper of kelvin_voigt is multiplied by s', so that it does not jump at first touch, and acts fully
// from w on. hunt_crossley keeps s: for any function of depth in its place, m v dv = -F(delta) (1 + a v)
// ddelta separates, and the speeds before and after an impact are related by the same G(a v) = a v - ln(1 + a
// v). Where the formula gives tension, the pressure and its derivatives are zero: a contact never pulls.
/// Evaluates the law at a gap [m] and its rate [m/s].
inline Pressure pressure(const PressureLaw& law, double gap, double gap_rate) {
  const double depth = -gap, rate = -gap_rate;
  if (!(depth > 0.0)) return {0.0, 0.0, 0.0, 0.0};
  const Onset s = onset(law.onset, depth);
  const double energy = law.k * s.integral;
  if (law.kind == PressureLaw::Kind::kKelvinVoigt) {
    const double p = law.k * s.value + law.d * s.slope * rate,
                 bend = depth < law.onset ? law.d * rate / law.onset : 0.0;
    return p > 0.0 ? Pressure{p, -law.k * s.slope - bend, -law.d * s.slope, energy}
                   : Pressure{0.0, 0.0, 0.0, energy};
  }
  const double factor = 1.0 + 1.5 * law.d * rate;
  return factor > 0.0 ? Pressure{law.k * s.value * factor, -law.k * s.slope * factor,
                                 -1.5 * law.k * law.d * s.value, energy}
                      : Pressure{0.0, 0.0, 0.0, energy};
}

/// Evaluates the pressure law. Resolves the names in `law` at each call. @throws Error for invalid parameters
/// @param law  stiffness, damping and onset  @param gap  [m], negative inside  @param gap_rate  [m/s]
Pressure pressure(const ContactSpec& law, double gap, double gap_rate);

/// Returns the root function of opening and closing [m]: negative while the law presses, positive while it
/// does not, and zero exactly where that changes. Continuous in gap and rate.
double pressing(const PressureLaw& law, double gap, double gap_rate);

}  // namespace palpate::contact
