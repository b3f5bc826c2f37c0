#include "scene/keys.h"

namespace palpate::scene {
namespace {

const KeyTable<MotionSpec>& motion_keys() {
  using Ranges = DeviceRanges;
  static const KeyTable<MotionSpec> keys = {
      text("kind", &MotionSpec::kind, {}, "stroke, tap, circle or chirp: palpate list motions"),
      required(vec3("amplitude_m", &MotionSpec::amplitude_m, any(),
                    "how far, and which way; of a circle: the half axis at its start")),
      vec3("second_amplitude_m", &MotionSpec::second_amplitude_m, any(),
           "the half axis of a circle a quarter of a turn on"),
      number("frequency_per_s", &MotionSpec::frequency_per_s, Ranges::frequency,
             "periods a second; of a chirp: at its start"),
      number("end_frequency_per_s", &MotionSpec::end_frequency_per_s, Ranges::frequency,
             "periods a second at the end of a chirp"),
      number("start_s", &MotionSpec::start_s, Ranges::start_s, "when it begins"),
      number("duration_s", &MotionSpec::duration_s, Ranges::duration_s,
             "how long it lasts, then it rests where it is; 0: to the end"),
  };
  return keys;
}

const KeyTable<PressSpec>& press_keys() {
  using Ranges = DeviceRanges;
  static const KeyTable<PressSpec> keys = {
      integer("switch", &PressSpec::number, Ranges::switches, "number of the switch"),
      number("start_s", &PressSpec::start_s, Ranges::start_s, "when it is pressed"),
      number("duration_s", &PressSpec::duration_s, Ranges::duration_s, "how long it is held; 0: to the end"),
  };
  return keys;
}

}  // namespace

const KeyTable<DeviceSpec>& device_keys() {
  using Ranges = DeviceRanges;
  using Spec = DeviceSpec;
  static const KeyTable<Spec> keys = {
      text("type", &Spec::type, {}, "what moves the handle"),
      text("profile", &Spec::profile, {}, "published figures of a device: palpate list device-profiles"),
      tables("keyframe", &Spec::keyframes, keyframe_keys(), "the path of the handle, in the order of time"),
      tables("motion", &Spec::motions, motion_keys(), "a motion by a formula, on top of the keyframes"),
      tables("press", &Spec::presses, press_keys(), "when a switch of the handle is held pressed"),
      unless("3.3, or the profile's", number("max_force_n", &Spec::max_force_n, Ranges::max_force_n,
                                             "largest force that the device lets through")),
      unless("0.2, or the profile's", number("max_torque_n_m", &Spec::max_torque_n_m, Ranges::max_torque_n_m,
                                             "largest torque that the device lets through")),
      unless("30000 max_force_n, with a profile 1885; in a hand 309, or the profile's stiffness times 1 m/s",
             number("max_force_slew_n_s", &Spec::max_force_slew_n_s, Ranges::slew,
                    "fastest change of the force")),
      unless("30000 max_torque_n_m, with a profile 1885; in a hand as the force",
             number("max_torque_slew_n_m_s", &Spec::max_torque_slew_n_m_s, Ranges::slew,
                    "fastest change of the torque")),
      unless("0.2 where somebody holds the device, else 0",
             number("ramp_s", &Spec::ramp_s, Ranges::ramp_s,
                    "time over which the force sets in at the start, and again after the device has failed")),
      vec3("workspace_center_m", &Spec::workspace_center_m, any(), "middle of the workspace"),
      unless("none, or the profile's",
             own_key<Spec>(
                 "workspace_size_m",
                 [](const Value& v, Spec& spec) {
                   spec.workspace_size_m = read_vec3(v, Ranges::workspace_size_m);
                 },
                 "three numbers", "", "extents of a box that the handle should not leave")),
      number("workspace_radius_m", &Spec::workspace_radius_m, Ranges::workspace_radius_m,
             "of a ball that the handle should not leave; 0: no ball"),
      number("workspace_margin_m", &Spec::workspace_margin_m, Ranges::workspace_margin_m,
             "distance outside the workspace over which the force fades"),
      number("arm_mass_kg", &Spec::arm_mass_kg, Ranges::arm, "of the arm, as it is felt at the handle"),
      number("arm_damping_n_s_m", &Spec::arm_damping_n_s_m, Ranges::arm,
             "of the arm about where it wants to be"),
      number("arm_stiffness_n_m", &Spec::arm_stiffness_n_m, Ranges::arm,
             "of the arm about where it wants to be: the keyframes"),
      number("rotational_inertia_kg_m2", &Spec::rotational_inertia_kg_m2, Ranges::inertia,
             "of hand and handle together"),
      number("arm_rotational_damping_n_m_s_rad", &Spec::arm_rotational_damping_n_m_s_rad, Ranges::arm,
             "of the wrist"),
      number("arm_rotational_stiffness_n_m_rad", &Spec::arm_rotational_stiffness_n_m_rad, Ranges::arm,
             "of the wrist"),
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
                    "step of the positions that are read; 0: exact")),
      number("encoder_resolution_rad", &Spec::encoder_resolution_rad, Ranges::resolution,
             "step of the angles that are read; 0: exact"),
      number("velocity_cutoff_per_s", &Spec::velocity_cutoff_per_s, Ranges::resolution,
             "cut-off of the filter that makes velocities of positions; 0: the exact velocity"),
      number("force_resolution_n", &Spec::force_resolution_n, Ranges::resolution,
             "step of the force that the motors give; 0: exact"),
      number("delay_s", &Spec::delay_s, Ranges::delay_s,
             "from a force that is sent to the motors' giving it"),
      unless("none", text("file", &Spec::file, {}, "recorded poses (CSV), from the scene's folder")),
      number("time_offset_s", &Spec::time_offset_s, any(),
             "added to the recording's times once they are scaled"),
      unless("1", in_unit("", number("time_scale", &Spec::time_scale, Ranges::time_scale,
                                     "seconds per unit of the recording's times: 0.001 for milliseconds; a "
                                     "given one is taken at its word"))),
      text("address", &Spec::address, {}, "IPv4 address that the peer's packets come to"),
      unless("none", integer("port", &Spec::port, Ranges::port, "UDP port that the peer's packets come to")),
      number("time_out_s", &Spec::time_out_s, Ranges::time_out_s,
             "how old the peer's last pose may be; then the watchdog acts"),
      number("wait_s", &Spec::wait_s, Ranges::wait_s,
             "longest wait for the peer's first pose, before the clock starts"),
  };
  return keys;
}

}  // namespace palpate::scene
