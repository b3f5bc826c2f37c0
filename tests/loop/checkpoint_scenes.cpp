#include "checkpoint_scenes.h"

#include <map>

namespace palpate::checkpoint_scenes {
namespace {

/// A block that is thrown onto the floor and slides there.
Case sliding_block() {
  Case c{small_scenes::held_block(), 0.01};
  scene::Description& d = c.scene;
  d.bodies[0].attachments.clear();
  d.bodies[0].velocity_m_s = Vec3(0.3, 0, 0);
  d.bodies[0].mesh.element_size_m = 0.02;
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  d.integrator.step_s = 0.001;
  d.integrator.linear_solver = "cholmod";
  d.exchange.contact_refresh_s = 0.002;
  ContactSpec law;
  law.first = "block";
  law.method = "analytic";
  law.stiffness_pa_m = 1e7;
  law.friction = 0.4;
  law.friction_tangent = FrictionTangent::kSymmetric;
  small_scenes::add_floor(d, law);
  return c;
}

#ifdef PALPATE_HAS_TOOL
/// A hand that presses into the block and moves along it.
Case pressed(const std::string& linearisation) {
  Case c{small_scenes::pressed_block(0.0), 0.02};
  scene::Description& d = c.scene;
  d.bodies[0].mesh.element_size_m = 0.02;
  d.duration_s = 0.08;
  KeyframeSpec down = d.device->keyframes.front();
  down.time_s = 0.05;
  down.position_m += Vec3(0.002, 0.0, -0.006);
  down.rotation_vector_rad = Vec3(0.1, -0.2, 0.3);
  d.device->keyframes.push_back(down);
  d.exchange.linearisation = linearisation;
  d.exchange.linearisation_error = 0.0;
  d.integrator.step_s = 0.005;
  d.integrator.linear_solver = "cholmod";
  d.contacts[0].friction = 0.3;
  c.energy = true;
  return c;
}
#endif

using Cases = std::map<std::string, Case>;

Cases make_cases() {
  Cases out;
  out["Sliding"] = sliding_block();
  out["NearestPoints"] = sliding_block();
  out["NearestPoints"].scene.contacts[0].method = "distance";
  Case& stiffer = out["MaterialChange"] = falling_body("linearly-implicit-euler");
  stiffer.scene.bodies[0].changes = {{0.005, 2e4, ""}, {0.025, 5e3, ""}};
  stiffer.scene.integrator.linear_solver = "cholmod";
  stiffer.energy = true;
#ifdef PALPATE_HAS_TOOL
  out["Points"] = pressed("points");
  out["Points"].scene.bodies[0].velocity_m_s = Vec3(0.0, 0.0, -0.05);  // energy at the start
  out["Condensed"] = pressed("condensed");
  Case& frozen = out["Frozen"] = pressed("frozen");
  frozen.scene.tool->integrator = "semi-implicit-euler";
  frozen.scene.device->ramp_s = 0.07;
  frozen.scene.device->max_force_n = 0.5;
  frozen.scene.device->max_torque_n_m = 0.01;
  frozen.scene.device->max_force_slew_n_s = 80.0;
  frozen.scene.device->max_torque_slew_n_m_s = 1.6;
  frozen.scene.device->keyframes[1].time_s = 0.0405;  // after a checkpoint, so that the slew is bounded there
  frozen.scene.device->keyframes[1].interpolation = Interpolation::kStep;
  Case& late = out["Late"] = pressed("points");
  late.scene.exchange.latency_ticks = 13;
  Case& hand = out["SimulatedHand"] = pressed("points");
  hand.scene.device->type = "hand";
  hand.scene.device->device_friction_n = 0.05;
  hand.scene.device->delay_s = 0.0025;
  hand.scene.device->encoder_resolution_m = 1e-5;
  hand.scene.device->velocity_cutoff_per_s = 200.0;
  hand.scene.device->device_damping_n_s_m = 0.5;
  hand.passivity = device::PassivityController::Mode::kControl;
  // a delayed spring returns more energy than it received where the hand reverses
  Case& controlled = out["ControlledHand"] = hand;
  controlled.scene.device->device_damping_n_s_m = 0.0;
  controlled.scene.device->encoder_resolution_m = 0.0;
  controlled.scene.device->delay_s = 0.0065;
  controlled.telling = 0;  // the controller is active at that checkpoint
  controlled.scene.device->arm_mass_kg = 0.1;
  controlled.scene.device->arm_stiffness_n_m = 3000.0;
  controlled.scene.device->arm_damping_n_s_m = 20.0;
  controlled.scene.device->keyframes[1].time_s = 0.03;
  controlled.scene.device->keyframes.push_back(controlled.scene.device->keyframes[0]);
  controlled.scene.device->keyframes[2].time_s = 0.06;
  Case& exact = out["ExactHand"] = pressed("points");
  exact.scene.device->type = "hand";
  Case& one = out["Monolithic"] = pressed("points");
  one.scene.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  one.scene.exchange.exchange_period_s = one.scene.exchange.contact_refresh_s = 0.002;
  one.scene.integrator.step_s = 0.001;
  Case& single = out["SingleRate"] = pressed("points");
  single.scene.exchange.scheme = scene::ExchangeScheme::kSingleRate;
  Case& single_hand = out["SingleRateHand"] = controlled;
  single_hand.scene.exchange.scheme = scene::ExchangeScheme::kSingleRate;
#ifdef PALPATE_HAS_GL
  Case& images = out["Images"] = pressed("points");
  images.scene.contacts[0].method = "image";
#endif
  Case& two = out["TwoHands"] = pressed("points");
  scene::HandSpec& left = two.scene.hands.emplace_back();
  left.name = "left";
  left.tool = *two.scene.tool;
  left.tool.position_m += Vec3(0.0, 0.01, 0.0);
  left.device = *two.scene.device;
  for (KeyframeSpec& key : left.device.keyframes) key.position_m += Vec3(0.0, 0.01, 0.0);
  two.scene.contacts.push_back(two.scene.contacts[0]);
  two.scene.contacts[1].second = "left";
  Case& meet = out["ToolsMeet"] = pressed("points");  // one above the other, which presses on the block
  scene::HandSpec& above = meet.scene.hands.emplace_back();
  above.name = "above";
  above.tool = *meet.scene.tool;
  above.tool.position_m += Vec3(0.002, 0.0, 0.03);
  above.device = *meet.scene.device;
  for (KeyframeSpec& key : above.device.keyframes) key.position_m += Vec3(0.002, 0.0, 0.029);
  meet.scene.contacts.push_back(meet.scene.contacts[0]);
  meet.scene.contacts[1].first = "above";
  meet.scene.contacts[1].method = "auto";
  Case& soft = out["SoftTool"] = pressed("points");
  soft.scene.contacts.clear();
  AttachmentSpec carried;
  carried.to = "tool";
  carried.region = Selection::kBox;
  carried.box_min_m = Vec3(-1, -1, 0.019);
  carried.box_max_m = Vec3(1, 1, 0.021);
  soft.scene.bodies[0].attachments.push_back(carried);
  Case& grasp = out["Grasp"] = pressed("points");
  grasp.scene.tool->grasp_switch = 1;
  grasp.scene.device->presses = {{1, 0.031, 1.0}};
#endif
  return out;
}

const Cases& cases() {
  static const Cases all = make_cases();
  return all;
}

}  // namespace

std::vector<std::string> case_names() {
  std::vector<std::string> out;
  for (const auto& [name, one] : cases()) out.push_back(name);
  return out;
}

Case find_case(const std::string& name) { return cases().at(name); }

}  // namespace palpate::checkpoint_scenes
