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
  };
  return registry;
}

std::unique_ptr<Device> make_device(const DeviceSpec& spec, const std::string& folder) {
  return find(device_registry(), spec.type, "device type").make(spec, folder);
}

}  // namespace palpate::device
