#include "device/motions.h"

#include <cmath>
#include <numbers>

#include "palpate/core/error.h"
#include "palpate/device/keyframes.h"

namespace palpate::device {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// x = A sin(w s)
Displacement stroke(const MotionSpec& m, double s) {
  const double w = kTurn * m.frequency_per_s;
  return {m.amplitude_m * std::sin(w * s), m.amplitude_m * (w * std::cos(w * s)),
          m.amplitude_m * (-w * w * std::sin(w * s))};
}

// x = A (1 - cos(w s))/2: from rest to A and back, once per period
Displacement tap(const MotionSpec& m, double s) {
  const double w = kTurn * m.frequency_per_s;
  return {m.amplitude_m * (0.5 - 0.5 * std::cos(w * s)), m.amplitude_m * (0.5 * w * std::sin(w * s)),
          m.amplitude_m * (0.5 * w * w * std::cos(w * s))};
}

// x = A (cos(w s) - 1) + B sin(w s): an ellipse with half axes A and B through the starting point
Displacement circle(const MotionSpec& m, double s) {
  const double w = kTurn * m.frequency_per_s, c = std::cos(w * s), n = std::sin(w * s);
  return {m.amplitude_m * (c - 1.0) + m.second_amplitude_m * n,
          w * (m.second_amplitude_m * c - m.amplitude_m * n),
          -w * w * (m.amplitude_m * c + m.second_amplitude_m * n)};
}

// x = A sin(phi), phi' = w(s) = 2 pi (f0 + (f1 - f0) s/D), so phi = 2 pi (f0 s + (f1 - f0) s^2/(2 D))
Displacement chirp(const MotionSpec& m, double s) {
  const double rate = (m.end_frequency_per_s - m.frequency_per_s) / m.duration_s;
  const double phi = kTurn * (m.frequency_per_s * s + 0.5 * rate * s * s);
  const double w = kTurn * (m.frequency_per_s + rate * s);
  return {m.amplitude_m * std::sin(phi), m.amplitude_m * (w * std::cos(phi)),
          m.amplitude_m * (kTurn * rate * std::cos(phi) - w * w * std::sin(phi))};
}

}  // namespace

const Registry<MakeMotion>& motion_registry() {
  static const Registry<MakeMotion> registry = {
      {"stroke", "sinusoidal motion along amplitude_m", 0, stroke, {{.name = "duration_s"}}},
      {"tap",
       "motion from rest to the amplitude and back, once per period",
       0,
       tap,
       {{.name = "duration_s"}}},
      {"circle",
       "motion along an ellipse with semi-axes amplitude_m and second_amplitude_m",
       0,
       circle,
       {{.name = "second_amplitude_m", .required = true}, {.name = "duration_s"}}},
      {"chirp",
       "sinusoidal motion whose frequency changes linearly",
       0,
       chirp,
       {{.name = "end_frequency_per_s", .required = true},
        {.name = "duration_s",
         .range = Range::positive("it is the duration of the sweep"),
         .required = true}}},
  };
  return registry;
}

Displacement displacement(const MotionSpec& m, double t) {
  const double s = t - m.start_s;
  if (!(s >= 0.0)) return {};
  const auto at = find(motion_registry(), m.kind, "motion").make;
  if (!(m.duration_s > 0.0) || s < m.duration_s) return at(m, s);
  return {at(m, m.duration_s).x, Vec3::Zero(), Vec3::Zero()};
}

void check_motion(const MotionSpec& m, const std::string& where) {
  const auto check = [&](const char* key, double value, const Range& range) {
    if (!range.holds(value)) fail("{}: {} = {} {}", where, key, value, range.demand());
  };
  find(motion_registry(), m.kind, where + ": kind");
  if (!m.amplitude_m.allFinite() || !m.second_amplitude_m.allFinite())
    fail("{}: amplitudes must be finite numbers", where);
  check("frequency_per_s", m.frequency_per_s, DeviceRanges::frequency);
  check("end_frequency_per_s", m.end_frequency_per_s, DeviceRanges::frequency);
  check("start_s", m.start_s, DeviceRanges::start_s);
  check("duration_s", m.duration_s, DeviceRanges::duration_s);
  if (m.kind == "chirp" && m.duration_s == 0.0)
    fail("{}: duration_s = 0 must be positive; it is the duration of the sweep", where);
}

namespace {

void check_press(const PressSpec& press, const std::string& where) {
  const auto check = [&](const char* key, double value, const Range& range) {
    if (!range.holds(value)) fail("{}: {} = {} {}", where, key, value, range.demand());
  };
  check("switch", press.number, DeviceRanges::switches);
  check("start_s", press.start_s, DeviceRanges::start_s);
  check("duration_s", press.duration_s, DeviceRanges::duration_s);
}

std::uint32_t switches_at(const std::vector<PressSpec>& presses, double t) {
  std::uint32_t out = 0;
  for (const PressSpec& press : presses)
    if (t >= press.start_s && (press.duration_s == 0.0 || t < press.start_s + press.duration_s))
      out |= 1U << static_cast<unsigned>(press.number);
  return out;
}

}  // namespace

DevicePath path_of(const DeviceSpec& spec) {
  check_keyframes(spec.keyframes, "device");
  for (std::size_t i = 0; i < spec.motions.size(); ++i)
    check_motion(spec.motions[i], fmt::format("device: motion[{}]", i));
  for (std::size_t i = 0; i < spec.presses.size(); ++i)
    check_press(spec.presses[i], fmt::format("device: press[{}]", i));
  return [keyframes = spec.keyframes, motions = spec.motions, presses = spec.presses](double t) {
    HandleSample out = sample_keyframes(keyframes, t);
    out.switches = switches_at(presses, t);
    for (const MotionSpec& motion : motions) {
      const Displacement d = displacement(motion, t);
      out.pose.translation += d.x;
      out.twist.linear += d.v;
      out.acceleration.linear += d.a;
    }
    return out;
  };
}

}  // namespace palpate::device
