#include "cases.h"
#include "faults.h"
#include "palpate/core/error.h"
#include "palpate/experiments/exchange_period_study.h"
#include "palpate/loop/run.h"

// Problem: a round tool presses a soft block, with the handle on a path with two continuous derivatives.
//
// Exact answer: the monolithic solution, in which one integrator advances tool and block without exchange.
// The partitioned scheme uses over each exchange period H a contact that is linear in time and in the tool's
// motion, and advances the tool by a first-order tick of H/10. Both errors are O(H), so that
//     |F_partitioned - F_monolithic| = C H + O(H^2)
// for force and torque on the hand and for the block's nodes. Measured: these distances and their order,
// accepted from 0.85 to 2.2. The contact is refreshed at the same times in all runs. The coupling oscillates
// at w = sqrt(300 / 0.05) = 77/s: H w from 0.096 to 0.012.
//
// The block applies a moment to a round tool by friction alone: the handle rotates and drags the tool
// sideways, and the regularised friction remains below its cap, where it is mu p v/v_r and smooth. (On the
// cap it has a kink, which is not an error of the exchange.) The share of the contact in the tool's torque is
// measured too.

namespace palpate::validation {
namespace {

scene::Description press_block() {
  scene::Description d;
  d.name = "press-block";
  d.duration_s = 0.06;
  SoftBodySpec block;
  block.name = "block";
  block.mesh.generator = "box";
  block.mesh.size_m = Vec3(0.04, 0.04, 0.02);
  block.mesh.element_size_m = 0.01;
  block.position_m = Vec3(0, 0, 0.01);
  block.youngs_modulus_pa = 1e4;
  block.poissons_ratio = 0.4;
  block.stiffness_damping_s = 2e-3;
  AttachmentSpec floor;
  floor.box_min_m = Vec3(-1, -1, -1e-6);
  floor.box_max_m = Vec3(1, 1, 1e-6);
  block.attachments = {floor};
  d.bodies.push_back(block);
  ContactSpec contact;
  contact.first = "block";
  contact.second = "tool";
  contact.stiffness_pa_m = 1e7;
  contact.friction = 0.5;
  contact.friction_regularisation_m_s = 0.3;
  d.contacts.push_back(contact);
  d.tool.emplace();
  d.tool->radius_m = 0.015;
  d.tool->mass_kg = 0.05;
  d.tool->position_m = Vec3(0.001, 0.002, 0.035);
  d.tool->coupling.stiffness_n_m = 300;
  d.tool->coupling.damping_n_s_m = 4;
  d.tool->coupling.rotational_stiffness_n_m_rad = 0.02;  // Oscillates at 67/s: I = 2/5 m r^2 = 4.5e-6 kg m^2
  d.tool->coupling.rotational_damping_n_m_s_rad = 3e-4;
  d.device.emplace();
  KeyframeSpec touch, deep;
  touch.position_m = d.tool->position_m;
  deep = touch;
  deep.time_s = 0.08;
  deep.position_m += Vec3(0.003, -0.002, -0.004);
  deep.rotation_vector_rad = Vec3(0.1, 0.2, 0.3);
  d.device->keyframes = {touch, deep};
  d.compare.exchange_periods_s = {1.25e-3, 6.25e-4, 3.125e-4, 1.5625e-4};
  return d;
}

/// Largest moment of the contact on the tool, largest torque on the hand, and largest speed of a tool point
/// [m/s], as the sum of tangential and rotational speed.
struct ContactMoment final : loop::Observer {
  void tick(const loop::TickRecord& tick) override {
    moment = std::max(moment, tick.contact.moment.norm());
    torque = std::max(torque, tick.requested.moment.norm());
    speed = std::max(speed, tick.tool_twist.linear.head<2>().norm() +
                                press_block().tool->radius_m * tick.tool_twist.angular.norm());
  }
  double moment = 0.0, torque = 0.0, speed = 0.0;
};

ContactMoment contact_moment(scene::Description d) {
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = d.compare.exchange_periods_s.back();
  d.tool->tick_s = 0.1 * d.exchange.exchange_period_s;
  const auto world = loop::assemble(d);
  ContactMoment out;
  loop::RunOptions options;
  options.observers = {&out};
  if (!loop::run(*world, options).status.ok()) fail("partitioned against monolithic: the run failed");
  return out;
}

std::vector<Measurement> run(const std::string& fault) {
  const scene::Description parts = press_block();
  compare::ExchangeOptions options;
  options.seed_defect = [&](loop::World& world) {
    if (fault == "half-contact") add_to(world, scaled(world.contact, {.force = -0.5}));
    if (fault == "half-stiffness")
      world.set_youngs_modulus(world.bodies[0], 0.5 * parts.bodies[0].youngs_modulus_pa);
  };
  std::vector<double> periods, force, torque, position;
  std::string table;
  for (const compare::ExchangePoint& point : compare::compare_exchange(parts, options).points) {
    periods.push_back(point.exchange_period_s);
    force.push_back(point.error.force_rms_n);
    torque.push_back(point.error.torque_rms_n_m);
    position.push_back(point.error.position_rel_l2);
    table += fmt::format("{}{:g} ms: {:.2e} N, {:.2e} N m, {:.2e}", table.empty() ? "" : "; ",
                         1e3 * periods.back(), force.back(), torque.back(), position.back());
  }
  std::vector<Measurement> out;
  const auto add = [&](const std::string& quantity, const std::vector<double>& errors, double bar) {
    out.push_back({.quantity = quantity,
                   .computed = errors.back(),
                   .error = errors.back(),
                   .bar = bar,
                   .order = validation::fitted_order(periods, errors),
                   .order_low = 0.85,
                   .order_high = 2.2,
                   .note = table,
                   .refinement = {"exchange period [s]", periods, errors}});
  };
  const ContactMoment contact = contact_moment(parts);
  const double share = contact.moment / contact.torque, limit = parts.contacts[0].friction_regularisation_m_s;
  out.push_back({.quantity = "moment of the contact / torque on the hand, largest of each (must be > 0.1)",
                 .computed = share,
                 .error = share > 0.1 && contact.speed < limit ? 0.0 : 1.0,
                 .bar = 0.5,
                 .note = fmt::format("{:.2e} and {:.2e} N m; friction below its cap: {:.3f} of {:g} m/s",
                                     contact.moment, contact.torque, contact.speed, limit)});
  add("force on the hand, RMS error at the shortest period [N]", force, 1e-3);
  add("torque on the hand, RMS error at the shortest period [N m]", torque, 1e-5);
  add("nodes of the block, error at the shortest period, rel. L2", position, 3e-3);
  return out;
}

}  // namespace

ValidationCase partitioned_monolithic() {
  return {
      .name = "partitioned-monolithic",
      .section = "E",
      .summary =
          "a block pressed in two rates converges to the monolithic solution as the exchange period "
          "decreases",
      .why =
          "an exchange that lacks a part of the response of the bodies does not converge to the reference; "
          "the device force is only as accurate as this error",
      .quick = true,
      .run = run,
      .faults = {{"half-contact", "RMS error"}, {"half-stiffness", "nodes of the block"}}};
}

}  // namespace palpate::validation
