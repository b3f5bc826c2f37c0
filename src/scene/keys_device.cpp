#include "scene/keys.h"

namespace palpate::scene {
namespace {

const KeyTable<MotionSpec>& motion_keys() {
  using Ranges = DeviceRanges;
  static const KeyTable<MotionSpec> keys = {
      text("kind", &MotionSpec::kind, {}, "stroke, tap, circle or chirp: palpate list motions"),
      required(vec3("amplitude_m", &MotionSpec::amplitude_m, any(),
                    "amplitude as a vector; for a circle: the half axis at its start")),
      vec3("second_amplitude_m", &MotionSpec::second_amplitude_m, any(),
           "half axis of a circle a quarter of a turn later"),
      number("frequency_per_s", &MotionSpec::frequency_per_s, Ranges::frequency,
             "periods per second; for a chirp: at its start"),
      number("end_frequency_per_s", &MotionSpec::end_frequency_per_s, Ranges::frequency,
             "periods per second at the end of a chirp"),
      number("start_s", &MotionSpec::start_s, Ranges::start_s, "time at which the motion begins"),
      number("duration_s", &MotionSpec::duration_s, Ranges::duration_s,
             "duration of the motion, which then stops in place; 0: to the end of the run"),
  };
  return keys;
}

const KeyTable<PressSpec>& press_keys() {
  using Ranges = DeviceRanges;
  static const KeyTable<PressSpec> keys = {
      integer("switch", &PressSpec::number, Ranges::switches, "number of the switch"),
      number("start_s", &PressSpec::start_s, Ranges::start_s, "time at which it is pressed"),
      number("duration_s", &PressSpec::duration_s, Ranges::duration_s,
             "time for which it is held; 0: to the end of the run"),
  };
  return keys;
}

/// Keys of every device: its path, the limits of its force and its workspace.
KeyTable<DeviceSpec> common_keys() {
  using Ranges = DeviceRanges;
  using Spec = DeviceSpec;
  return {
      text("type", &Spec::type, {}, "what moves the handle"),
      text("profile", &Spec::profile, {},
           "published specifications of a device: palpate list device-profiles"),
      tables("keyframe", &Spec::keyframes, keyframe_keys(), "path of the handle, in order of time"),
      tables("motion", &Spec::motions, motion_keys(), "a motion by a formula, added to the keyframes"),
      tables("press", &Spec::presses, press_keys(),
             "an interval during which a switch of the handle is pressed"),
      unless("3.3, or the profile's", number("max_force_n", &Spec::max_force_n, Ranges::max_force_n,
                                             "maximum force that the device renders")),
      unless("0.2, or the profile's", number("max_torque_n_m", &Spec::max_torque_n_m, Ranges::max_torque_n_m,
                                             "maximum torque that the device renders")),
      unless("30000 max_force_n, with a profile 1885 max_force_n; in a hand 309, or the profile's stiffness "
             "times 1 m/s",
             number("max_force_slew_n_s", &Spec::max_force_slew_n_s, Ranges::slew,
                    "maximum rate of change of the force")),
      unless("30000 max_torque_n_m, with a profile 1885 max_torque_n_m; in a hand as for the force",
             number("max_torque_slew_n_m_s", &Spec::max_torque_slew_n_m_s, Ranges::slew,
                    "maximum rate of change of the torque")),
      unless("0.2 if a person holds the device, else 0",
             number("ramp_s", &Spec::ramp_s, Ranges::ramp_s,
                    "time over which the force is ramped up at the start and after a failure of the device")),
      vec3("workspace_center_m", &Spec::workspace_center_m, any(), "centre of the workspace"),
      unless("none, or the profile's",
             own_key<Spec>(
                 "workspace_size_m",
                 [](const Value& v, Spec& spec) {
                   spec.workspace_size_m = read_vec3(v, Ranges::workspace_size_m);
                 },
                 "three numbers", "", "extents of a box that the handle should not leave")),
      number("workspace_radius_m", &Spec::workspace_radius_m, Ranges::workspace_radius_m,
             "radius of a ball that the handle should not leave; 0: no ball"),
      number("workspace_margin_m", &Spec::workspace_margin_m, Ranges::workspace_margin_m,
             "distance outside the workspace over which the force fades"),
  };
}

/// Keys of a simulated hand.
KeyTable<DeviceSpec> simulated_hand_keys() {
  using Ranges = DeviceRanges;
  using Spec = DeviceSpec;
  return {
      number("arm_mass_kg", &Spec::arm_mass_kg, Ranges::arm, "effective mass of the arm at the handle"),
      number("arm_damping_n_s_m", &Spec::arm_damping_n_s_m, Ranges::arm,
             "damping of the arm about its target pose"),
      number("arm_stiffness_n_m", &Spec::arm_stiffness_n_m, Ranges::arm,
             "stiffness of the arm about its target pose, given by the keyframes"),
      number("rotational_inertia_kg_m2", &Spec::rotational_inertia_kg_m2, Ranges::inertia,
             "rotational inertia of hand and handle together"),
      number("arm_rotational_damping_n_m_s_rad", &Spec::arm_rotational_damping_n_m_s_rad, Ranges::arm,
             "rotational damping of the wrist"),
      number("arm_rotational_stiffness_n_m_rad", &Spec::arm_rotational_stiffness_n_m_rad, Ranges::arm,
             "rotational stiffness of the wrist"),
      unless("0.045, or the profile's", number("device_mass_kg", &Spec::device_mass_kg, Ranges::inertia,
                                               "apparent mass of the device at its handle")),
      unless("0", number("device_damping_n_s_m", &Spec::device_damping_n_s_m, Ranges::arm,
                         "viscous friction of the device")),
      unless("0, or the profile's", number("device_friction_n", &Spec::device_friction_n, Ranges::arm,
                                           "Coulomb friction of the device, along each axis")),
      number("rotational_friction_n_m", &Spec::rotational_friction_n_m, Ranges::arm,
             "Coulomb friction of the device, about each axis"),
      unless("0, or the profile's",
             number("encoder_resolution_m", &Spec::encoder_resolution_m, Ranges::resolution,
                    "quantisation step of the measured positions; 0: exact")),
      number("encoder_resolution_rad", &Spec::encoder_resolution_rad, Ranges::resolution,
             "quantisation step of the measured angles; 0: exact"),
      number("velocity_cutoff_per_s", &Spec::velocity_cutoff_per_s, Ranges::resolution,
             "cut-off of the filter that computes velocities from positions; 0: the exact velocity"),
      number("force_resolution_n", &Spec::force_resolution_n, Ranges::resolution,
             "quantisation step of the motors' force; 0: exact"),
      number("delay_s", &Spec::delay_s, Ranges::delay_s, "delay from a force command to the motors' output"),
  };
}

/// Keys of a recording and of a peer on the network.
KeyTable<DeviceSpec> source_keys() {
  using Ranges = DeviceRanges;
  using Spec = DeviceSpec;
  return {
      unless("none", text("file", &Spec::file, {}, "recorded poses (CSV), relative to the scene's folder")),
      number("time_offset_s", &Spec::time_offset_s, any(),
             "offset added to the recording's times after scaling"),
      unless("1", in_unit("", number("time_scale", &Spec::time_scale, Ranges::time_scale,
                                     "seconds per unit of the recording's times: 0.001 for milliseconds; a "
                                     "given value is used unchecked"))),
      text("address", &Spec::address, {}, "local IPv4 address that receives the peer's packets"),
      unless("none", integer("port", &Spec::port, Ranges::port, "UDP port that receives the peer's packets")),
      number("time_out_s", &Spec::time_out_s, Ranges::time_out_s,
             "maximum age of the peer's last pose before the watchdog acts"),
      number("wait_s", &Spec::wait_s, Ranges::wait_s,
             "longest wait for the peer's first pose, before the clock starts"),
  };
}

/// Keys of a driver in a shared object and of devices with rate control.
KeyTable<DeviceSpec> driver_keys() {
  using Ranges = DeviceRanges;
  using Spec = DeviceSpec;
  const auto start = [](const char* name, std::optional<Vec3> Spec::*member, const char* meaning) {
    return unless("the tool's",
                  own_key<Spec>(
                      name, [member](const Value& v, Spec& spec) { spec.*member = read_vec3(v, any()); },
                      "three numbers", "", meaning));
  };
  return {
      unless("none",
             text("library", &Spec::library, {},
                  "shared object with a driver: a path from the scene's folder, or a name that the loader "
                  "finds")),
      unless("none", text("library_options", &Spec::library_options, {},
                          "text that the driver receives, such as the name of a serial port")),
      unless("the device's", text("input", &Spec::input, {},
                                  "socket of the daemon (spacemouse), or event file such as "
                                  "/dev/input/event5 (gamepad)")),
      number("max_speed_m_s", &Spec::max_speed_m_s, Ranges::full_speed,
             "speed of the handle at full deflection"),
      number("max_turn_rate_rad_s", &Spec::max_turn_rate_rad_s, Ranges::full_speed,
             "angular speed of the handle at full deflection"),
      number("dead_zone", &Spec::dead_zone, Ranges::dead_zone,
             "part of the full deflection of each axis that does not move the handle"),
      vec3("mounting_rotation_rad", &Spec::mounting_rotation_rad, any(),
           "rotation vector that turns the device's axes (right x, away from the user y, up z) into the "
           "scene's"),
      start("start_position_m", &Spec::start_position_m, "position of the handle at the start"),
      start("start_rotation_vector_rad", &Spec::start_rotation_vector_rad,
            "orientation of the handle at the start"),
  };
}

}  // namespace

const KeyTable<DeviceSpec>& device_keys() {
  static const KeyTable<DeviceSpec> keys = [] {
    KeyTable<DeviceSpec> out = common_keys();
    for (const auto& more : {simulated_hand_keys(), source_keys(), driver_keys()})
      out.insert(out.end(), more.begin(), more.end());
    return out;
  }();
  return keys;
}

}  // namespace palpate::scene
