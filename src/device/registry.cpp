#include "palpate/device/registry.h"

#include "device/make.h"

namespace palpate::device {
namespace {

std::vector<PartKey> hand_keys() {
  std::vector<PartKey> keys = part_keys(
      {"motion", "press", "arm_mass_kg", "arm_damping_n_s_m", "arm_stiffness_n_m", "rotational_inertia_kg_m2",
       "arm_rotational_damping_n_m_s_rad", "arm_rotational_stiffness_n_m_rad", "device_mass_kg",
       "device_damping_n_s_m", "device_friction_n", "rotational_friction_n_m", "encoder_resolution_m",
       "encoder_resolution_rad", "velocity_cutoff_per_s", "force_resolution_n", "delay_s"});
  keys.insert(keys.begin(), {.name = "keyframe", .required = true});
  return keys;
}

std::vector<PartKey> rate_keys() {
  return part_keys({"input", "max_speed_m_s", "max_turn_rate_rad_s", "dead_zone", "mounting_rotation_rad",
                    "start_position_m", "start_rotation_vector_rad"});
}

}  // namespace

const Registry<MakeDevice>& device_registry() {
  static const Registry<MakeDevice> registry = {
      {"script",
       "prescribed motion along the keyframes of the scene, independent of the force",
       0,
       make_script,
       {{.name = "keyframe", .required = true}, {.name = "motion"}, {.name = "press"}}},
      {"hand", "simulated device held by a simulated arm that yields to the force", 0, make_hand,
       hand_keys()},
      {"recording",
       "prescribed motion along recorded poses",
       0,
       make_recording,
       {{.name = "file", .required = true}, {.name = "time_offset_s"}, {.name = "time_scale"}}},
      {"udp",
       "peer on the network (UDP) that sends poses and receives wrenches",
       0,
       make_udp,
       {{.name = "port", .required = true}, {.name = "address"}, {.name = "time_out_s"}, {.name = "wait_s"}}},
      {"plugin",
       "driver in a shared object, by the C interface palpate/device/plugin.h",
       0,
       make_plugin,
       {{.name = "library", .required = true}, {.name = "library_options"}, {.name = "start_position_m"}}},
      {"spacemouse", "six-degree-of-freedom mouse (daemon spacenavd) that sets the velocity of the handle", 0,
       make_spacemouse, rate_keys()},
      {"gamepad", "game pad (Linux event device) that sets the velocity of the handle; rumbles by the force",
       0, make_gamepad, rate_keys()},
  };
  return registry;
}

std::unique_ptr<Device> make_device(const DeviceSpec& spec, const std::string& folder) {
  return find(device_registry(), spec.type, "device type").make(spec, folder);
}

}  // namespace palpate::device
