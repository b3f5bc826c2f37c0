#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/keys.h"
#include "palpate/core/types.h"

namespace palpate {

/// One pose that a scripted motion goes through.
struct KeyframeSpec {
  double time_s = 0.0;                      ///< when the frame is there
  Vec3 position_m = Vec3::Zero();           ///< where its origin is then
  Vec3 rotation_vector_rad = Vec3::Zero();  ///< its orientation then
  /// towards this keyframe: "minimum_jerk" (quintic, at rest at each keyframe), "linear", "step"
  std::string interpolation = "minimum_jerk";
};

/// A motion by a formula on top of the keyframes: [[device.motion]].
struct MotionSpec {
  std::string kind = "stroke";             ///< "stroke", "tap", "circle", "chirp"
  Vec3 amplitude_m = Vec3::Zero();         ///< half way of a stroke, depth of a tap, half axis of a circle
  Vec3 second_amplitude_m = Vec3::Zero();  ///< of a circle: its other half axis
  double frequency_per_s = 1.0;            ///< of a chirp: at its start
  double end_frequency_per_s = 1.0;        ///< of a chirp
  double start_s = 0.0;                    ///< when it begins
  double duration_s = 0.0;                 ///< 0: to the end; a chirp needs it
};

/// A time through which a switch of the handle is held pressed: [[device.press]].
struct PressSpec {
  int number = 0;           ///< of the switch
  double start_s = 0.0;     ///< when it is pressed
  double duration_s = 0.0;  ///< 0: to the end
};

/// The `[device]` table of a scene.  What is not given comes from the profile, else from a default.
struct DeviceSpec {
  std::string type = "script";          ///< see `palpate list devices`
  std::string profile{};                ///< published figures of a device; empty: none
  std::vector<KeyframeSpec> keyframes;  ///< the script's poses, times ascending
  std::vector<MotionSpec> motions;      ///< added to the script
  std::vector<PressSpec> presses;       ///< of the handle's switches

  std::optional<double> max_force_n;            ///< 3.3, of a common desktop device
  std::optional<double> max_torque_n_m;         ///< 0.2
  std::optional<double> max_force_slew_n_s;     ///< empty: by type and profile (profile.cpp)
  std::optional<double> max_torque_slew_n_m_s;  ///< likewise
  /// force ramps in from zero over this time at the start and after each failure of the device; empty: 0.2 s
  /// of a device that somebody holds, 0 of those that the computer moves
  std::optional<double> ramp_s;
  Vec3 workspace_center_m = Vec3::Zero();  ///< middle of box and ball
  std::optional<Vec3> workspace_size_m;    ///< of a box
  double workspace_radius_m = 0.0;         ///< of a ball; 0: none
  double workspace_margin_m = 0.01;        ///< outside of it forces fade over this distance

  // of a simulated hand: the arm ...
  double arm_mass_kg = 0.8;                        ///< mass that moves with the hand
  double arm_damping_n_s_m = 5.5;                  ///< towards rest
  double arm_stiffness_n_m = 568.0;                ///< of the spring to where the hand wants to be
  double rotational_inertia_kg_m2 = 1e-3;          ///< of hand and handle
  double arm_rotational_damping_n_m_s_rad = 0.03;  ///< towards rest
  double arm_rotational_stiffness_n_m_rad = 2.0;   ///< of the spring to the wanted orientation
  // ... and the device in it
  std::optional<double> device_mass_kg;        ///< 0.045
  std::optional<double> device_damping_n_s_m;  ///< 0
  std::optional<double> device_friction_n;     ///< 0
  double rotational_friction_n_m = 0.0;        ///< Coulomb's, of rotations
  std::optional<double> encoder_resolution_m;  ///< 0: exact
  double encoder_resolution_rad = 0.0;         ///< steps of angles; 0: exact
  double velocity_cutoff_per_s = 0.0;          ///< of the filter of velocities; 0: the exact velocity
  double force_resolution_n = 0.0;             ///< steps of the motors' force; 0: exact
  double delay_s = 0.0;                        ///< from a sample to the wrench that it leads to

  std::string file{};                ///< of a recording, from the scene's folder
  double time_offset_s = 0.0;        ///< added to the recording's times once they are scaled
  std::optional<double> time_scale;  ///< seconds per unit of the recording's times; empty: 1, if plausible

  // of a peer on the network
  std::string address = "127.0.0.1";  ///< this machine's address that it listens on
  int port = 0;                       ///< UDP port that poses come to
  double time_out_s = 0.002;          ///< after the last pose samples are invalid
  double wait_s = 30.0;               ///< longest wait for the first pose, before the clock starts
};

/// What they may be: checked by the loader of scenes and by the device.
struct DeviceRanges {
  /// [N]
  static constexpr Range max_force_n = Range::positive("a desktop device gives 3.3");
  /// [N m]
  static constexpr Range max_torque_n_m = Range::at_least(0.0, "0 drives no torque; others give 0.2");
  /// [N/s, N m/s]
  static constexpr Range slew = Range::positive("a fall to zero within 10 ms needs 150 times the maximum");
  static constexpr Range ramp_s = Range::at_least(0.0, "0 is no ramp");  ///< [s]
  /// each extent [m]
  static constexpr Range workspace_size_m = Range::positive("leave it out for no box");
  static constexpr Range workspace_radius_m = Range::at_least(0.0, "0 is no ball");  ///< [m]
  static constexpr Range workspace_margin_m = Range::positive("0.01 is usual");      ///< [m]
  /// mass or moment of inertia [kg, kg m^2]
  static constexpr Range inertia = Range::positive("0.05 kg is a light device's, 1e-3 kg m^2 a hand's");
  static constexpr Range arm = Range::at_least(0.0, "0 leaves it out");  ///< spring or damper of the arm
  static constexpr Range resolution =
      Range::at_least(0.0, "0 is exact");  ///< steps of positions, angles, forces
  /// [s]
  static constexpr Range delay_s = Range::closed(0.0, 1.0, "a loop of 1 kHz has one of 0.001");
  static constexpr Range frequency =
      Range::positive("a hand moves at up to 10");  ///< of a motion, or the filter's cut-off [1/s]
  /// [s]
  static constexpr Range start_s = Range::at_least(0.0, "0 is the start of the run");
  static constexpr Range duration_s = Range::at_least(0.0, "0 is to the end");  ///< [s]
  static constexpr Range switches = Range::closed(0, 31, "the first is 0");     ///< a switch's number
  /// a UDP port
  static constexpr Range port = Range::closed(1, 65535, "above 1023 no rights are needed");
  /// [s]
  static constexpr Range time_out_s = Range::positive("two ticks, 0.002, are usual");
  /// [s]
  static constexpr Range wait_s = Range::positive("30 leaves time to start the peer");
  /// seconds per unit of a recording's times
  static constexpr Range time_scale = Range::positive("0.001 is for milliseconds, 1e-6 for microseconds");
};

}  // namespace palpate
