#include "body_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/clock.h"
#include "coupling/carried_bodies.h"
#include "linearise.h"
#include "palpate/core/error.h"

namespace palpate::loop {

int whole_number(double ratio) { return std::max(1, static_cast<int>(std::lround(ratio))); }

BodyLoop::BodyLoop(World& world, const RunOptions& options, RunResult& result)
    : world_(world), options_(options), result_(result) {
  const scene::Description& d = world.description;
  for (ToolInstance& tool : world.tools) {
    const double tick_s = tool.spec.tick_s;
    HandTicks& record_tick = hand_ticks_.emplace_back();
    tool.passivity = device::make_passivity_controller(options.passivity, tool.device_spec, tick_s);
    if (tick_s * device::kBuzzFrequency < 0.25) record_tick.vibration.emplace(tick_s);
  }
  duration_ = options.duration_s > 0.0 ? options.duration_s : d.duration_s;
  period_ = period_of(d);
  if (duration_ == std::numeric_limits<double>::infinity()) {
    endless_ = true;
    periods_ = std::numeric_limits<int>::max();
    duration_ = periods_ * period_;
    return;
  }
  if (!(duration_ / period_ < 1e9))
    fail(
        "duration_s = {} is {:.3g} exchange periods of {} s, more than the limit of 1e9; choose a shorter "
        "duration",
        duration_, duration_ / period_, period_);
  periods_ = whole_number(std::ceil(duration_ / period_ - 1e-9));
}

void BodyLoop::start() {
  if (world_.stepper) world_.stepper->set_interrupt(options_.stop);
  const auto& observers = options_.observers;
  if (std::any_of(observers.begin(), observers.end(), [](const Observer* o) { return o->wants_energy(); }))
    ledger_.emplace(world_).start();
  for (Observer* observer : observers) observer->period(world_, 0.0);
}

// Uses the switch at the last tick. Within a period the ticks are ahead of the bodies.
void BodyLoop::query() {
  for (const ToolInstance& tool : world_.tools)
    if (tool.spec.grasp_switch >= 0 && tool.frame >= 0)
      world_.contact->set_grasp(tool.frame, (tool.handle.switches >> tool.spec.grasp_switch) & 1U);
  query_contact();
}

void BodyLoop::query_contact() {
  if (!world_.contact) return;
  if (ledger_) ledger_->before_query();
  const bool changed = [&] {
    const ScopedTimer timer(result_.query_s);
    return world_.contact->refresh(world_.state.view());
  }();
  if (ledger_) ledger_->after_query();
  if (changed && world_.stepper) world_.stepper->reinit(dynamics::ReinitReason::kContactRefreshed);
  for (Observer* observer : options_.observers) observer->queried(world_, world_.state.time());
}

ContactRecord BodyLoop::linearise(std::size_t hand, double period_s) {
  const ContactRecord record = [&] {
    const ScopedTimer timer(result_.linearise_s);
    return linearise_contact(world_, ++hand_ticks_[hand].version, period_s, result_.frozen_fallbacks, hand);
  }();
  for (Observer* observer : options_.observers) observer->exchanged_of(hand, record);
  return record;
}

void BodyLoop::follow(std::size_t hand, double t, const Pose& pose, const Twist& twist) {
  world_.tools[hand].partitioned()->path->append(t, pose, twist);
}

void BodyLoop::restart_path() {
  for (ToolInstance& tool : world_.tools)
    if (PartitionedTool* partitioned = tool.partitioned()) partitioned->path->restart();
}

void BodyLoop::record_tick(std::size_t hand, const TickRecord& tick) {
  device::HandleSample& handle = world_.tools[hand].handle;
  handle.pose = tick.handle;
  handle.twist = tick.handle_twist;
  handle.valid = tick.handle_valid;
  handle.switches = tick.switches;
  ++hand_ticks_[hand].ticks;
  if (hand_ticks_[hand].vibration) hand_ticks_[hand].vibration->add(tick.device.force);
  if (ledger_) ledger_->tick(hand, tick.time, tick.requested, tick.handle_twist);
  for (Observer* observer : options_.observers) observer->tick_of(hand, tick);
}

double BodyLoop::next_query(double t0, double t1) {
  const scene::CosimulationSpec& exchange = world_.description.exchange;
  if (!world_.contact || exchange.tunnelling != scene::TunnellingPolicy::kSubstep) return t1;
  const double safe = world_.contact->statistics().safe_time, rest = t1 - t0;
  const double requested = std::ceil(rest / safe - 1e-9),
               most = std::max(1.0, std::floor(rest / exchange.shortest_refresh_s + 1e-9));
  if (!(requested > 1.0) || most <= 1.0) return t1;
  ++result_.sub_steps;
  result_.shortest_refreshes += requested > most;
  return t0 + rest / std::min(requested, most);
}

void BodyLoop::advance(double t0, double t1, double refresh_s) {
  if (!world_.stepper) return world_.state.set_time(t1);  // only a tool with separate ticks
  const int parts = world_.contact ? whole_number((t1 - t0) / refresh_s) : 1;
  for (int i = 0; i < parts; ++i) {
    if (i > 0) query_contact();
    const double start = t0 + i * (t1 - t0) / parts,
                 end = i + 1 == parts ? t1 : t0 + (i + 1) * (t1 - t0) / parts;
    for (double t = start; t < end;) {
      if (t > start) query_contact();
      t = next_query(t, end);
      advance_over_changes(t);
      if (!result_.status.ok()) return;
    }
  }
}

/// Advances to t, with stops at material changes.
void BodyLoop::advance_over_changes(double t) {
  for (;;) {
    const double stop = next_change();
    const bool on_the_way = stop < t * (1.0 - 1e-12);
    const double to = on_the_way ? stop : t;
    result_.status = monolithic_ticks_ ? monolithic_ticks_->advance_to(to) : world_.stepper->advance_to(to);
    if (!result_.status.ok()) return;
    if (stop <= t * (1.0 + 1e-12)) change_materials(stop);
    if (!on_the_way) return;
  }
}

void BodyLoop::hold_bodies(double t1) {
  for (double stop = next_change(); stop <= t1; stop = next_change()) change_materials(stop);
  const dynamics::StateView then = world_.state.view();
  for (const ToolInstance& tool : world_.tools) {
    const PartitionedTool* partitioned = tool.partitioned();
    if (!partitioned || partitioned->ties.empty()) continue;
    const auto& path = *partitioned->path;
    carry_along(world_.state, partitioned->ties, {path.pose(then), path.twist(then)},
                {path.last().pose, path.last().twist});
  }
  world_.state.set_time(t1);
  if (world_.stepper) world_.stepper->reinit(dynamics::ReinitReason::kStateChanged);
}

double BodyLoop::next_change() const {
  double next = HUGE_VAL;
  for (const SoftBodySpec& spec : world_.description.bodies)
    for (const MaterialChangeSpec& change : spec.changes)
      if (change.time_s > changed_) next = std::min(next, change.time_s);
  return next;
}

void BodyLoop::change_materials(double time) {
  changed_ = time;
  if (ledger_) ledger_->before_material();
  for (std::size_t i = 0; i < world_.bodies.size(); ++i)
    for (const MaterialChangeSpec& change : world_.description.bodies[i].changes)
      if (change.time_s == time)
        world_.set_youngs_modulus(world_.bodies[i], change.youngs_modulus_pa, change.region);
  if (ledger_) ledger_->after_material();
}

void BodyLoop::close_period(double t1) {
  ++result_.periods;
  result_.time = t1;
  for (Observer* observer : options_.observers) observer->period(world_, t1);
  if (ledger_) {
    result_.energy = ledger_->period(t1);
    for (Observer* observer : options_.observers) observer->energy(*result_.energy);
  }
  if (options_.progress) options_.progress(t1 / duration_);
}

bool BodyLoop::ended() {
  if (result_.status.status == dynamics::StepStatus::kInterrupted) {
    result_.status = {};
    result_.stopped = true;
  }
  return !result_.status.ok() || result_.stopped;
}

void BodyLoop::finish() {
  if (world_.stepper) world_.stepper->set_interrupt(nullptr);
  sum_up();
}

void BodyLoop::sum_up() {
  result_.more_hands.clear();
  if (world_.stepper) result_.counters = counted_before_ + world_.stepper->counters();
  if (world_.contact) {
    result_.contact_queries = world_.contact->statistics().queries;
    result_.tunnelled.clear();
    for (const contact::PairReport& pair : world_.contact->pairs())
      result_.tunnelled.push_back(pair.tunnelled);
  }
  for (std::size_t i = 0; i < hand_ticks_.size(); ++i) {
    const ToolInstance& tool = world_.tools[i];
    HandResult hand;
    hand.ticks = hand_ticks_[i].ticks;
    hand.limited_ticks = tool.limiter.limited_ticks();
    hand.outside_ticks = tool.limiter.outside_ticks();
    hand.rejected_ticks = tool.limiter.rejected_ticks();
    hand.ticks_without_pose = tool.limiter.ticks_without_pose();
    if (hand_ticks_[i].vibration) hand.buzz_n = hand_ticks_[i].vibration->rms();
    if (tool.passivity) {
      const device::PassivityObserver& port = tool.passivity->observer();
      hand.port = {port.energy(), port.least_energy(), port.work(), tool.passivity->dissipated(),
                   tool.passivity->active_ticks()};
    }
    if (i > 0) {
      result_.more_hands.push_back(hand);
      continue;
    }
    result_.ticks = hand.ticks;
    result_.limited_ticks = hand.limited_ticks;
    result_.outside_ticks = hand.outside_ticks;
    result_.rejected_ticks = hand.rejected_ticks;
    result_.ticks_without_pose = hand.ticks_without_pose;
    result_.buzz_n = hand.buzz_n;
    result_.port = hand.port;
  }
}

}  // namespace palpate::loop
