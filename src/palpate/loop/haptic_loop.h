#pragma once
#include <string>

#include "palpate/device/arm_axis.h"

namespace palpate::loop {

/// One translational axis of the haptic loop: device and arm, sampled; a virtual coupling; a tool; a wall.
/// With the tool held, the coupling itself is the virtual wall K, B of the literature.
struct HapticLoop {
  /// The device at its handle, and an arm that grips it rigidly.
  struct Axis {
    double mass_kg = 0.045;          ///< the order of a desktop device's
    double damping_n_s_m = 0.1;      ///< of the device's own friction, viscous; its order, not measured
    double arm_mass_kg = 0.0;        ///< 0: the device is let go of
    double arm_damping_n_s_m = 0.0;  ///< to the ground
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
  int delay_ticks = 0;  ///< whole ticks between a sample and the force made of it

  double coupling_stiffness_n_m = 300.0, coupling_damping_n_s_m = 2.0;
  bool tool_held = false;  ///< at the origin: the rest does not count
  double tool_mass_kg = 0.1;
  std::string tool_integrator = "linearly-implicit-euler";
  double contact_stiffness_n_m = 0.0, contact_damping_n_s_m = 0.0;  ///< between tool and wall; 0: no wall
};

/// How the motion of a loop ends that starts half way to its equilibrium.
struct PressedWall {
  bool stable = false;
  double growth = 0.0;         ///< largest coupling deflection of the last quarter over that of the second
  double largest_force = 0.0;  ///< on the hand [N]
};

/// Simulates it with the ticks of a run (TickSide: coupling, tool scheme, limiter) against a device that is
/// exact between its ticks.  Where there is a contact the wall is one-sided, and the arm presses the tool on
/// it with `force_n`; else there is no force, and the motion starts at a deflection of 10 um.
/// @throws Error for a tool integrator that is not there, without tools in the build
PressedWall press_wall(const HapticLoop& loop, double duration_s, double force_n = 1.0);

}  // namespace palpate::loop
