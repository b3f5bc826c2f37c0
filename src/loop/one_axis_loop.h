#pragma once
#include <string>

#include "device/arm_axis.h"

namespace palpate::loop {

/// One translational axis of the haptic loop: sampled device and arm, virtual coupling, tool, and wall. With
/// the tool held, the coupling is the virtual wall K, B of the literature.
struct OneAxisLoop {
  /// The device at its handle, and an arm that grips it rigidly.
  struct Axis {
    double mass_kg = 0.045;          ///< Order of magnitude of a desktop device.
    double damping_n_s_m = 0.1;      ///< Viscous friction of the device; order of magnitude, not measured.
    double arm_mass_kg = 0.0;        ///< 0: nobody holds the device
    double arm_damping_n_s_m = 0.0;  ///< To the ground.
    double arm_stiffness_n_m = 0.0;
    double total_mass() const { return mass_kg + arm_mass_kg; }
    double total_damping() const { return damping_n_s_m + arm_damping_n_s_m; }
    bool held() const { return arm_mass_kg > 0.0 || arm_damping_n_s_m > 0.0 || arm_stiffness_n_m > 0.0; }
    device::ArmAxis::Parameters arm() const {
      return {total_mass(), total_damping(), arm_stiffness_n_m, 0.0};
    }
  };
  Axis device;
  double tick_s = 1e-3;
  int delay_ticks = 0;  ///< Whole ticks between a sample and the force computed from it.

  double coupling_stiffness_n_m = 300.0, coupling_damping_n_s_m = 2.0;
  bool tool_held = false;  ///< Tool fixed at the origin; the parameters below are ignored.
  double tool_mass_kg = 0.1;
  std::string tool_integrator = "linearly-implicit-euler";
  double contact_stiffness_n_m = 0.0, contact_damping_n_s_m = 0.0;  ///< Between tool and wall; 0: no wall.
};

/// Stability of the motion of a haptic loop that starts half way to its equilibrium.
struct VirtualWallResult {
  bool stable = false;
  double growth = 0.0;  ///< Largest coupling deflection in the last quarter, relative to the second quarter.
  double largest_force = 0.0;  ///< Largest force on the hand [N].
};

/// Simulates the loop with the ticks of a run (HapticLoop: coupling, tool scheme, limiter) and a device that
/// is integrated exactly between ticks. With a contact the wall is one-sided, and the arm presses the tool on
/// it with `force_n`; otherwise there is no force, and the motion starts at a deflection of 10 um.
/// @throws Error for an unknown tool integrator, or in a build without tools
VirtualWallResult simulate_virtual_wall(const OneAxisLoop& loop, double duration_s, double force_n = 1.0);

}  // namespace palpate::loop
