#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/keys.h"
#include "palpate/core/types.h"

namespace palpate {

/// Interpolation of a path between two keyframes.
enum class Interpolation {
  kMinimumJerk,  ///< Quintic, at rest at each keyframe.
  kLinear,       ///< Constant velocity.
  kStep,         ///< Jump at the time of the second keyframe.
};
/// Returns the names of the values.
constexpr std::array<std::string_view, 3> option_names(Interpolation) {
  return {"minimum_jerk", "linear", "step"};
}

/// One pose of a scripted motion.
struct KeyframeSpec {
  double time_s = 0.0;                                        ///< Time of the keyframe.
  Vec3 position_m = Vec3::Zero();                             ///< Position of the origin.
  Vec3 rotation_vector_rad = Vec3::Zero();                    ///< Orientation.
  Interpolation interpolation = Interpolation::kMinimumJerk;  ///< From the previous keyframe.
};

/// Motion by a formula, added to the keyframes: [[device.motion]].
struct MotionSpec {
  std::string kind = "stroke";             ///< "stroke", "tap", "circle", "chirp"
  Vec3 amplitude_m = Vec3::Zero();         ///< Half width of a stroke, depth of a tap, half axis of a circle.
  Vec3 second_amplitude_m = Vec3::Zero();  ///< Other half axis of a circle.
  double frequency_per_s = 1.0;            ///< Frequency; of a chirp, at its start.
  double end_frequency_per_s = 1.0;        ///< Frequency of a chirp at its end.
  double start_s = 0.0;                    ///< Start of the motion.
  double duration_s = 0.0;                 ///< 0: to the end of the run; required for a chirp
};

/// Interval during which a switch of the handle is pressed: [[device.press]].
struct PressSpec {
  int number = 0;           ///< Index of the switch.
  double start_s = 0.0;     ///< Time at which it is pressed.
  double duration_s = 0.0;  ///< 0: to the end of the run
};

/// Parameters of the device, the `[device]` table of a scene. Values that are not given come from the
/// profile, then from defaults.
struct DeviceSpec {
  std::string type = "script";          ///< See `palpate list devices`
  std::string profile{};                ///< Published figures of a device; empty: none.
  std::vector<KeyframeSpec> keyframes;  ///< Poses of the script, times ascending.
  std::vector<MotionSpec> motions;      ///< Motions added to the script.
  std::vector<PressSpec> presses;       ///< Presses of the handle's switches.

  std::optional<double> max_force_n;            ///< Default 3.3, as of a common desktop device.
  std::optional<double> max_torque_n_m;         ///< Default 0.2.
  std::optional<double> max_force_slew_n_s;     ///< Empty: by type and profile (profile.cpp).
  std::optional<double> max_torque_slew_n_m_s;  ///< Empty: by type and profile (profile.cpp).
  /// Duration over which the force ramps in from zero at the start and after each failure of the device.
  /// Empty: 0.2 s for a device that a person holds, 0 for devices that the computer moves.
  std::optional<double> ramp_s;
  Vec3 workspace_center_m = Vec3::Zero();  ///< Centre of box and ball.
  std::optional<Vec3> workspace_size_m;    ///< Extents of the box.
  double workspace_radius_m = 0.0;         ///< Radius of the ball; 0: none.
  double workspace_margin_m = 0.01;        ///< Distance outside over which forces fade.

  // Simulated hand: the arm ...
  double arm_mass_kg = 0.8;                        ///< Mass that moves with the hand.
  double arm_damping_n_s_m = 5.5;                  ///< Damper of the arm.
  double arm_stiffness_n_m = 568.0;                ///< Spring to the target position.
  double rotational_inertia_kg_m2 = 1e-3;          ///< Hand and handle together.
  double arm_rotational_damping_n_m_s_rad = 0.03;  ///< Damper of the arm.
  double arm_rotational_stiffness_n_m_rad = 2.0;   ///< Spring to the target orientation.
  // ... and the device in it
  std::optional<double> device_mass_kg;        ///< Default 0.045.
  std::optional<double> device_damping_n_s_m;  ///< Default 0.
  std::optional<double> device_friction_n;     ///< Default 0.
  double rotational_friction_n_m = 0.0;        ///< Coulomb friction of rotations.
  std::optional<double> encoder_resolution_m;  ///< 0: exact
  double encoder_resolution_rad = 0.0;         ///< Resolution of angles; 0: exact.
  double velocity_cutoff_per_s = 0.0;          ///< Cut-off of the velocity filter; 0: the exact velocity.
  double force_resolution_n = 0.0;             ///< Resolution of the motors' force; 0: exact.
  double delay_s = 0.0;                        ///< From a sample to the wrench computed from it.

  std::string file{};                ///< Path of a recording, relative to the scene's folder.
  double time_offset_s = 0.0;        ///< Added to the recording's times after scaling.
  std::optional<double> time_scale;  ///< Seconds per unit of the recording's times; empty: 1, if plausible.

  // Peer on the network.
  std::string address = "127.0.0.1";  ///< Local address to listen on.
  int port = 0;                       ///< UDP port that receives poses.
  double time_out_s = 0.002;          ///< Samples are invalid this long after the last pose.
  double wait_s = 30.0;               ///< Longest wait for the first pose, before the clock starts.

  // Driver in a shared object.
  std::string library{};          ///< Path relative to the scene's folder, or a name that the loader finds.
  std::string library_options{};  ///< Text for the driver, such as the name of a serial port.

  // Rate control: the deflection of a stick or a knob sets the velocity of the handle.
  std::string input{};                            ///< Socket or event file; empty: found by the device.
  double max_speed_m_s = 0.1;                     ///< Speed at full deflection.
  double max_turn_rate_rad_s = 1.0;               ///< Angular speed at full deflection.
  double dead_zone = 0.1;                         ///< Part of the full deflection that has no effect.
  Vec3 mounting_rotation_rad = Vec3::Zero();      ///< Rotation vector from the device's axes to the scene's.
  std::optional<Vec3> start_position_m;           ///< Handle at the start; empty: at the tool.
  std::optional<Vec3> start_rotation_vector_rad;  ///< Orientation at the start; empty: the tool's.
};

/// Valid ranges of the parameters, checked by the scene loader and by the device.
struct DeviceRanges {
  /// Maximum force [N].
  static constexpr Range max_force_n = Range::positive("a desktop device reaches 3.3");
  /// Maximum torque [N m].
  static constexpr Range max_torque_n_m =
      Range::at_least(0.0, "0 disables torque; desktop devices reach 0.2");
  /// Slew rates [N/s, N m/s].
  static constexpr Range slew = Range::positive("a fall to zero within 10 ms needs 150 times the maximum");
  static constexpr Range ramp_s = Range::at_least(0.0, "0 disables the ramp");  ///< [s]
  /// Each extent of the box [m].
  static constexpr Range workspace_size_m = Range::positive("omit it for no box");
  static constexpr Range workspace_radius_m = Range::at_least(0.0, "0 disables the ball");  ///< [m]
  static constexpr Range workspace_margin_m = Range::positive("0.01 is usual");             ///< [m]
  /// Mass or moment of inertia [kg, kg m^2].
  static constexpr Range inertia = Range::positive("a light device has 0.05 kg, a hand 1e-3 kg m^2");
  static constexpr Range arm = Range::at_least(0.0, "0 disables it");      ///< Spring or damper of the arm.
  static constexpr Range resolution = Range::at_least(0.0, "0 is exact");  ///< Positions, angles, forces.
  /// Delay of the motors [s].
  static constexpr Range delay_s = Range::closed(0.0, 1.0, "a loop of 1 kHz has 0.001");
  static constexpr Range frequency =
      Range::positive("a hand moves at up to 10");  ///< Motion, or cut-off of the velocity filter [1/s].
  /// Start of a motion or a press [s].
  static constexpr Range start_s = Range::at_least(0.0, "0 is the start of the run");
  static constexpr Range duration_s = Range::at_least(0.0, "0 means until the end");  ///< [s]
  static constexpr Range switches = Range::closed(0, 31, "the first switch is 0");    ///< Index of a switch.
  /// UDP port.
  static constexpr Range port = Range::closed(1, 65535, "ports above 1023 need no privileges");
  /// Age at which the last pose becomes invalid [s].
  static constexpr Range time_out_s = Range::positive("two ticks, 0.002, are usual");
  /// Longest wait for the first pose [s].
  static constexpr Range wait_s = Range::positive("30 leaves time to start the peer");
  /// Speed of the handle at full deflection [m/s, rad/s].
  static constexpr Range full_speed = Range::at_least(0.0, "0 holds the handle");
  /// Part of the full deflection.
  static constexpr Range dead_zone = Range::closed(0.0, 0.9, "0.1 is usual");
  /// Seconds per unit of a recording's times.
  static constexpr Range time_scale = Range::positive("0.001 is for milliseconds, 1e-6 for microseconds");
};

}  // namespace palpate
