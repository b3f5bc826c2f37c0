#include "loop/energy.h"

#include <cmath>

#include "core/counters.h"
#include "tool/rigid_block.h"
#include "tool_instance.h"

namespace palpate::loop {

void PowerIntegral::start(double t, double power) {
  *this = {};
  t_ = t_coarse_ = t;
  power_ = power_coarse_ = power;
}

void PowerIntegral::add(double t, double power) {
  fine_ += 0.5 * (t - t_) * (power_ + power);
  t_ = t;
  power_ = power;
  odd_ = !odd_;
  if (odd_) return;
  coarse_ += 0.5 * (t - t_coarse_) * (power_coarse_ + power);
  t_coarse_ = t;
  power_coarse_ = power;
  at_coarse_ = fine_;
}

void PowerIntegral::archive(Archive& a) {
  a("t", t_);
  a("power", power_);
  a("t_coarse", t_coarse_);
  a("power_coarse", power_coarse_);
  a("fine", fine_);
  a("coarse", coarse_);
  a("at_coarse", at_coarse_);
  a("odd", odd_);
}

double PowerIntegral::error() const { return std::abs(at_coarse_ - coarse_) / 3.0; }

namespace {

double power_on(const Wrench& wrench, const Twist& twist) {
  return wrench.moment.dot(twist.angular) + wrench.force.dot(twist.linear);
}

}  // namespace

EnergyLedger::EnergyLedger(World& world) : world_(world) { counters::count("loop.energy_ledger"); }

double EnergyLedger::contact_energy() const {
  return world_.contact ? world_.contact->energy(world_.state.view()) : 0.0;
}

double EnergyLedger::elastic_energy() const {
  const dynamics::StateView view = world_.state.view();
  double sum = 0.0;
  for (const Body& body : world_.bodies)
    sum += body.term->energy(view) + (body.dilatation ? body.dilatation->energy(view) : 0.0);
  return sum;
}

// A coupling dissipates b |v_h - v_t|^2 + b_r |w_h - w_t|^2. Couplings of tools in the State are terms of the
// System; a tool with separate ticks is not.
EnergyLedger::Dissipation EnergyLedger::dissipation() const {
  Dissipation out;
  const dynamics::StateView view = world_.state.view();
  for (const auto& term : world_.system.terms())
    (term == world_.contact ? out.contact : out.bodies) += term->dissipated_power(view);
  for (std::size_t i = 0; i < world_.tools.size(); ++i) {
    const VirtualCouplingSpec& c = world_.tools[i].spec.coupling;
    const Twist tool = world_.tool_twist(i);
    const Twist& hand = world_.tools[i].handle.twist;
    out.coupling += c.damping_n_s_m * (hand.linear - tool.linear).squaredNorm() +
                    c.rotational_damping_n_m_s_rad * (hand.angular - tool.angular).squaredNorm();
  }
  if (!world_.has_tool_of_ticks()) out.bodies -= out.coupling;
  return out;
}

void EnergyLedger::take_stored() {
  const dynamics::StateView view = world_.state.view();
  balance_.kinetic = view.layout->blocks.empty() ? 0.0 : world_.system.kinetic_energy(view);
  balance_.elastic = elastic_energy();
  balance_.contact = contact_energy();
  balance_.other =
      world_.system.potential_energy(view) - balance_.elastic - balance_.contact - other_at_start_;
  balance_.kinetic_of_tools = balance_.coupling = 0.0;
  for (std::size_t i = 0; i < world_.tools.size(); ++i) {
    tool::Tool& probe = probes_[i];
    probe.set_state(world_.state.time(), world_.tool_pose(i), world_.tool_twist(i));
    const Pose& handle = world_.tools[i].handle.pose;
    balance_.kinetic_of_tools += probe.kinetic_energy();
    balance_.coupling += probe.coupling_energy(handle);
    if (world_.tools[i].monolithic()) continue;  // terms of the System
    balance_.kinetic += probe.kinetic_energy();
    balance_.other += probe.potential_energy(handle);
  }
}

void EnergyLedger::make_probes() {
  probes_.clear();
  for (const ToolInstance& tool : world_.tools)
    probes_.emplace_back(tool.spec, world_.description.gravity_m_s2);
}

void EnergyLedger::archive(Archive& a) {
  if (a.is_restoring()) {
    make_probes();
    hands_.resize(world_.tools.size());
  }
  a("time", balance_.time);
  visit_energies([&](const char* name, double& value) { a(name, value); }, balance_);
  a("stored_at_start", stored_at_start_);
  a("other_at_start", other_at_start_);
  a.each("work_of_hand", hands_, [&](PowerIntegral& hand) { hand.archive(a); });
  a("work_of_supports", supports_);
  a("dissipation_in_bodies", in_bodies_);
  a("dissipation_in_contact", in_contact_);
  a("dissipation_in_coupling", in_coupling_);
}

void EnergyLedger::start() {
  const double t = world_.state.time();
  balance_ = {};
  other_at_start_ = 0.0;
  make_probes();
  take_stored();
  other_at_start_ = balance_.other;
  balance_.other = 0.0;
  stored_at_start_ = balance_.stored();
  hands_.clear();
  for (std::size_t i = 0; i < world_.tools.size(); ++i) {
    const device::HandleSample& handle = world_.tools[i].handle;
    const Wrench on_hand = tool::coupling_on_hand(
        world_.tools[i].spec, {world_.tool_pose(i), world_.tool_twist(i)}, {handle.pose, handle.twist});
    hands_.emplace_back().start(t, -power_on(on_hand, handle.twist));
  }
  supports_.start(t, world_.system.support_power(world_.state.view()));
  const Dissipation now = dissipation();
  in_bodies_.start(t, now.bodies);
  in_contact_.start(t, now.contact);
  in_coupling_.start(t, now.coupling);
}

void EnergyLedger::before_query() { contact_before_ = contact_energy(); }
void EnergyLedger::after_query() { balance_.queries += contact_energy() - contact_before_; }
void EnergyLedger::before_material() { elastic_before_ = elastic_energy(); }
void EnergyLedger::after_material() { balance_.materials += elastic_energy() - elastic_before_; }

void EnergyLedger::tick(std::size_t hand, double t, const Wrench& on_hand, const Twist& handle) {
  hands_.at(hand).add(t, -power_on(on_hand, handle));
}

const EnergyBalance& EnergyLedger::period(double t) {
  balance_.time = t;
  take_stored();
  supports_.add(t, world_.system.support_power(world_.state.view()));
  const Dissipation now = dissipation();
  in_bodies_.add(t, now.bodies);
  in_contact_.add(t, now.contact);
  in_coupling_.add(t, now.coupling);
  balance_.hand = balance_.quadrature_error = 0.0;
  for (const PowerIntegral& hand : hands_) {
    balance_.hand += hand.value();
    balance_.quadrature_error += hand.error();
  }
  balance_.supports = supports_.value();
  balance_.dissipated_by_contact = in_contact_.value();
  balance_.dissipated_by_coupling = in_coupling_.value();
  balance_.dissipated = in_bodies_.value() + in_contact_.value() + in_coupling_.value();
  balance_.quadrature_error +=
      supports_.error() + in_bodies_.error() + in_contact_.error() + in_coupling_.error();
  balance_.unaccounted = balance_.stored() - stored_at_start_ - balance_.hand - balance_.supports -
                         balance_.queries - balance_.materials + balance_.dissipated;
  return balance_;
}

}  // namespace palpate::loop
