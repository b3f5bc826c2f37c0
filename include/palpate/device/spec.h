#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/keys.h"
#include "palpate/core/types.h"

namespace palpate {

struct KeyframeSpec {
  double time_s = 0.0;
  Vec3 position_m = Vec3::Zero();
  Vec3 rotation_vector_rad = Vec3::Zero();
  /// towards this keyframe: "minimum_jerk" (quintic, at rest at each keyframe), "linear", "step"
  std::string interpolation = "minimum_jerk";
};

/// A motion by a formula on top of the keyframes: [[device.motion]].
struct MotionSpec {
  std::string kind = "stroke";  ///< "stroke", "tap", "circle", "chirp"
  Vec3 amplitude_m = Vec3::Zero();
  Vec3 second_amplitude_m = Vec3::Zero();  ///< of a circle: its other half axis
  double frequency_per_s = 1.0;            ///< of a chirp: at its start
  double end_frequency_per_s = 1.0;        ///< of a chirp
  double start_s = 0.0;
  double duration_s = 0.0;  ///< 0: to the end; a chirp needs it
};

/// A time through which a switch of the handle is held pressed: [[device.press]].
struct PressSpec {
  int number = 0;  ///< of the switch
  double start_s = 0.0;
  double duration_s = 0.0;  ///< 0: to the end
};

/// The `[device]` table of a scene.  What is not given comes from the profile, else from a default.
struct DeviceSpec {
  std::string type = "script";
  std::string profile{};  ///< published figures of a device; empty: none
  std::vector<KeyframeSpec> keyframes;
  std::vector<MotionSpec> motions;
  std::vector<PressSpec> presses;

  std::optional<double> max_force_n;     ///< 3.3, of a common desktop device
  std::optional<double> max_torque_n_m;  ///< 0.2
  std::optional<double> max_force_slew_n_s;
  std::optional<double> max_torque_slew_n_m_s;
  double ramp_s = 0.0;  ///< force ramps in from zero over this time at the start
  Vec3 workspace_center_m = Vec3::Zero();
  std::optional<Vec3> workspace_size_m;  ///< of a box
  double workspace_radius_m = 0.0;       ///< of a ball; 0: none
  double workspace_margin_m = 0.01;      ///< outside of it forces fade over this distance

  // of a simulated hand: the arm ...
  double arm_mass_kg = 0.8;
  double arm_damping_n_s_m = 5.5;
  double arm_stiffness_n_m = 568.0;
  double rotational_inertia_kg_m2 = 1e-3;
  double arm_rotational_damping_n_m_s_rad = 0.03;
  double arm_rotational_stiffness_n_m_rad = 2.0;
  // ... and the device in it
  std::optional<double> device_mass_kg;        ///< 0.045
  std::optional<double> device_damping_n_s_m;  ///< 0
  std::optional<double> device_friction_n;     ///< 0
  double rotational_friction_n_m = 0.0;
  std::optional<double> encoder_resolution_m;  ///< 0: exact
  double encoder_resolution_rad = 0.0;
  double velocity_cutoff_per_s = 0.0;  ///< of the filter of velocities; 0: the exact velocity
  double force_resolution_n = 0.0;
  double delay_s = 0.0;

  std::string file{};  ///< of a recording, from the scene's folder

  // of a peer on the network
  std::string address = "127.0.0.1";
  int port = 0;
  double time_out_s = 0.002;
};

/// What they may be: checked by the loader of scenes and by the device.
struct DeviceRanges {
  static constexpr Range max_force_n = Range::positive("a desktop device gives 3.3");
  static constexpr Range max_torque_n_m = Range::positive("a desktop device gives 0.2");
  static constexpr Range slew = Range::positive("a fall to zero within 10 ms needs 150 times the maximum");
  static constexpr Range ramp_s = Range::at_least(0.0, "0 is no ramp");
  static constexpr Range workspace_size_m = Range::positive("leave it out for no box");
  static constexpr Range workspace_radius_m = Range::at_least(0.0, "0 is no ball");
  static constexpr Range workspace_margin_m = Range::positive("0.01 is usual");
  static constexpr Range inertia = Range::positive("0.05 kg is a light device's, 1e-3 kg m^2 a hand's");
  static constexpr Range arm = Range::at_least(0.0, "0 leaves it out");
  static constexpr Range resolution = Range::at_least(0.0, "0 is exact");
  static constexpr Range delay_s = Range::closed(0.0, 1.0, "a loop of 1 kHz has one of 0.001");
  static constexpr Range frequency = Range::positive("a hand moves at up to 10");
  static constexpr Range start_s = Range::at_least(0.0, "0 is the start of the run");
  static constexpr Range duration_s = Range::at_least(0.0, "0 is to the end");
  static constexpr Range switches = Range::closed(0, 31, "the first is 0");
  static constexpr Range port = Range::closed(1, 65535, "above 1023 no rights are needed");
  static constexpr Range time_out_s = Range::positive("two ticks, 0.002, are usual");
};

}  // namespace palpate
