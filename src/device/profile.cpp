#include "palpate/device/profile.h"

#include <algorithm>
#include <numbers>

#include "device/check_range.h"
#include "palpate/core/registry.h"
#include "palpate/device/device.h"
#include "palpate/device/limiter.h"

namespace palpate::device {

// None of these devices drives torque: three motors move the tip.
//
// Figures as commonly quoted from the makers' data sheets, which were not at hand. The drivers of CHAI3D 3.2
// have the same maximum forces, and no torque: src/devices/CPhantomDevices.cpp (Omni 3.3 N; Premium 1.5 8.5
// N) and src/devices/CDeltaDevices.cpp, with Force Dimension as an author (omega.3 and omega.6 12 N). Damping
// is the maximum that these drivers recommend. The drivers recommend lower stiffnesses: 700, 800 and 5000
// N/m; the table has the makers' values, for the weakest direction if three are given.
//
// The Haply figures come from its driver for CHAI3D (github.com/HaplyHaptics/chai3d, 2019,
// src/devices/CHaplyDevices.cpp) for the pantograph, and from a user's driver for the Inverse3
// (github.com/jashenlow/chai3d_haply, 2024, same file). The former calls them estimates.
//
// No slew rate is published for these devices: it follows from kAmplifierBandwidth below.
namespace {

std::vector<DeviceProfile> devices_of_sensable() {
  return {
      // SensAble (later Geomagic) PHANTOM Premium 1.5: 381 x 267 x 191 mm, 0.03 mm, backdrive friction
      // 0.04 N, 8.5 N, 1.4 N continuous, 3.5 N/mm, apparent mass less than 75 g.
      {.name = "premium-1.5",
       .summary = "SensAble PHANTOM Premium 1.5: 8.5 N, 3.5 N/mm",
       .figures = {.name = "PHANTOM Premium 1.5",
                   .max_force = 8.5,
                   .max_continuous_force = 1.4,
                   .max_torque = 0.0,
                   .max_stiffness = 3500.0,
                   .max_damping = 5.0,
                   .workspace = Vec3(0.381, 0.267, 0.191),
                   .rate = {}},
       .mass = 0.075,
       .friction = 0.04,
       .encoder_resolution = 3e-5},
      // SensAble PHANTOM Omni (later Geomagic Touch): 160 x 120 x 70 mm, 0.055 mm, 0.26 N, 3.3 N, 0.88 N
      // continuous, 1.26, 2.31 and 1.02 N/mm, 45 g.
      {.name = "omni",
       .summary = "SensAble PHANTOM Omni: 3.3 N, 1 N/mm",
       .figures = {.name = "PHANTOM Omni",
                   .max_force = 3.3,
                   .max_continuous_force = 0.88,
                   .max_torque = 0.0,
                   .max_stiffness = 1020.0,
                   .max_damping = 5.0,
                   .workspace = Vec3(0.160, 0.120, 0.070),
                   .rate = {}},
       .mass = 0.045,
       .friction = 0.26,
       .encoder_resolution = 5.5e-5},
  };
}

std::vector<DeviceProfile> devices_of_force_dimension() {
  return {
      // Force Dimension omega.3 and omega.6: 160 mm across and 110 mm deep, 0.01 mm, 12 N
      // continuous, 14.5 N/mm closed loop, up to 4 kHz.  Mass and friction are not stated.
      {.name = "omega.3",
       .summary = "Force Dimension omega.3: 12 N, 14.5 N/mm",
       .figures = {.name = "omega.3",
                   .max_force = 12.0,
                   .max_continuous_force = 12.0,
                   .max_torque = 0.0,
                   .max_stiffness = 14500.0,
                   .max_damping = 30.0,
                   .workspace = Vec3(0.110, 0.160, 0.160),
                   .rate = 4000.0},
       .encoder_resolution = 1e-5},
      {.name = "omega.6",
       .summary = "Force Dimension omega.6: omega.3 with measured but undriven rotations",
       .figures = {.name = "omega.6",
                   .max_force = 12.0,
                   .max_continuous_force = 12.0,
                   .max_torque = 0.0,
                   .max_stiffness = 14500.0,
                   .max_damping = 30.0,
                   .workspace = Vec3(0.110, 0.160, 0.160),
                   .rate = 4000.0},
       .encoder_resolution = 1e-5},
  };
}

std::vector<DeviceProfile> devices_of_haply() {
  return {
      {.name = "haply-pantograph",
       .summary = "Haply Pantograph: 5 N, 0.3 N/mm, planar; estimates by its maker",
       .figures = {.name = "Haply Pantograph",
                   .max_force = 5.0,
                   .max_continuous_force = {},
                   .max_torque = 0.0,
                   .max_stiffness = 300.0,
                   .max_damping = 2.0,
                   .workspace = {},
                   .rate = {}}},
      {.name = "haply-inverse3",
       .summary = "Haply Inverse3: 10 N, 1 N/mm; values of a user's driver",
       .figures = {.name = "Haply Inverse3",
                   .max_force = 10.0,
                   .max_continuous_force = {},
                   .max_torque = 0.0,
                   .max_stiffness = 1000.0,
                   .max_damping = 6.0,
                   .workspace = Vec3::Constant(0.3),  // a ball of radius 0.15 m
                   .rate = {}}},
  };
}

}  // namespace

const std::vector<DeviceProfile>& device_profiles() {
  static const std::vector<DeviceProfile> profiles = [] {
    std::vector<DeviceProfile> out = devices_of_sensable();
    for (const auto& others : {devices_of_force_dimension(), devices_of_haply()})
      out.insert(out.end(), others.begin(), others.end());
    return out;
  }();
  return profiles;
}

namespace {

// A motor's amplifier controls its current as a first-order lag of bandwidth B [1/s]: after a step of the
// command from 0 to the maximum Fmax the force is Fmax (1 - exp(-2 pi B t)), with an initial slope 2 pi B
// Fmax. A command that changes faster is not reproduced. B = 300 1/s is a choice, not a data sheet value: it
// is below the inverse of the electrical time constant L/R, about 0.1 ms, of small coreless motors.
constexpr double kAmplifierBandwidth = 300.0;
constexpr double kAmplifierSlew = 2.0 * std::numbers::pi * kAmplifierBandwidth;

// The force on a hand must not change faster than touching can change it. A tapping hand meets a surface at
// about half a metre per second, at most at kFastestHand, and the stiffest wall that a device can render
// raises the force by its stiffness times that speed. A faster change is not a contact but a fault, such as a
// jump of the pose. The slew rate is relative to the maximum, so that it applies to other maxima; for a
// device without figures the Omni's are used, whose maximum is the default.
constexpr double kFastestHand = 1.0;  // [m/s]
constexpr double kStiffness = 1020.0;
constexpr double kRampWhereHeld = 0.2;  // [s]

constexpr double kMaxForce = 3.3, kMaxTorque = 0.2;
constexpr double kMass = 0.045;  ///< Mass of the lightest device above [kg].

Workspace workspace_of(const DeviceSpec& spec, const DeviceSpecification& figures) {
  check_range("workspace_radius_m", spec.workspace_radius_m, DeviceRanges::workspace_radius_m);
  check_range("workspace_margin_m", spec.workspace_margin_m, DeviceRanges::workspace_margin_m);
  if (!spec.workspace_center_m.allFinite()) fail("device: workspace_center_m must be three finite numbers");
  Workspace out{spec.workspace_center_m, Vec3::Zero(), spec.workspace_radius_m, spec.workspace_margin_m};
  if (spec.workspace_size_m) {
    for (const double one : *spec.workspace_size_m)
      check_range("workspace_size_m", one, DeviceRanges::workspace_size_m);
    out.size = *spec.workspace_size_m;
  } else if (figures.workspace && !(out.radius > 0.0)) {
    out.size = *figures.workspace;
  }
  return out;
}

/// Returns the slew rate in maxima per second [1/s] of a device that a person holds; at least the slope of
/// the watchdog's fall.
double slew_where_held(const DeviceSpecification& figures) {
  const bool stated = figures.max_stiffness && figures.max_force;
  return std::max(
      kFastestHand * (stated ? *figures.max_stiffness / *figures.max_force : kStiffness / kMaxForce),
      kLeastSlew);
}

/// Returns whether a person holds the device, who should not be pulled abruptly; script, recording and
/// simulated hand are moved by the computer.
bool is_held(const DeviceSpec& spec) {
  return spec.type != "script" && spec.type != "recording" && spec.type != "hand";
}

DeviceFigures effective_figures(const DeviceSpec& spec, const DeviceProfile& profile) {
  double slew = spec.profile.empty() ? kDefaultSlew : kAmplifierSlew;
  const auto& figures = profile.figures;
  if (is_held(spec)) slew = slew_where_held(figures);
  DeviceFigures out{};
  out.max_force = spec.max_force_n.value_or(figures.max_force.value_or(kMaxForce));
  out.max_torque = spec.max_torque_n_m.value_or(figures.max_torque.value_or(kMaxTorque));
  check_range("max_force_n", out.max_force, DeviceRanges::max_force_n);
  check_range("max_torque_n_m", out.max_torque, DeviceRanges::max_torque_n_m);
  out.max_force_slew = spec.max_force_slew_n_s.value_or(slew * out.max_force);
  out.max_torque_slew = spec.max_torque_slew_n_m_s.value_or(slew * out.max_torque);
  out.ramp = spec.ramp_s.value_or(is_held(spec) ? kRampWhereHeld : 0.0);
  out.workspace = workspace_of(spec, figures);
  out.mass = spec.device_mass_kg.value_or(profile.mass.value_or(kMass));
  out.damping = spec.device_damping_n_s_m.value_or(0.0);
  out.friction = spec.device_friction_n.value_or(profile.friction.value_or(0.0));
  out.encoder_resolution = spec.encoder_resolution_m.value_or(profile.encoder_resolution.value_or(0.0));
  check_range("device_mass_kg", out.mass, DeviceRanges::inertia);
  check_range("device_damping_n_s_m", out.damping, DeviceRanges::arm);
  check_range("device_friction_n", out.friction, DeviceRanges::arm);
  check_range("encoder_resolution_m", out.encoder_resolution, DeviceRanges::resolution);
  out.specification = figures;
  if (out.specification.name.empty()) out.specification.name = spec.type;
  out.specification.max_force = out.max_force;
  out.specification.max_torque = out.max_torque;
  if (!out.workspace.size.isZero(0.0)) out.specification.workspace = out.workspace.size;
  if (out.workspace.radius > 0.0) out.specification.workspace = Vec3::Constant(2.0 * out.workspace.radius);
  return out;
}

}  // namespace

DeviceFigures figures_of(const DeviceSpec& spec) {
  return effective_figures(
      spec, spec.profile.empty() ? DeviceProfile{} : find(device_profiles(), spec.profile, "device profile"));
}

DeviceSpec with_reported_limits(DeviceSpec spec, const Device& device) {
  const std::optional<DeviceSpecification> reported = device.reported();
  if (!reported || !spec.profile.empty()) return spec;
  DeviceProfile profile;
  profile.figures = *reported;
  const DeviceFigures figures = effective_figures(spec, profile);
  spec.max_force_n = figures.max_force;
  spec.max_torque_n_m = figures.max_torque;
  spec.max_force_slew_n_s = figures.max_force_slew;
  spec.max_torque_slew_n_m_s = figures.max_torque_slew;
  if (!figures.workspace.size.isZero(0.0)) spec.workspace_size_m = figures.workspace.size;
  return spec;
}

}  // namespace palpate::device
