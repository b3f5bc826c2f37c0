#include "palpate/loop/run.h"
#include "tool_side.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "linearise.h"
#include "monolithic_ticks.h"
#include "palpate/core/clock.h"
#include "palpate/core/error.h"
#include "palpate/core/workers.h"
#include "palpate/tool/rigid_block.h"
#include "palpate/tool/tool.h"

namespace palpate::loop {
namespace {

int whole_number(double ratio) { return std::max(1, static_cast<int>(std::lround(ratio))); }

/// One run: the State of the loop itself.
class Loop {
 public:
  Loop(World& world, const RunOptions& options)
      : world_(world), side_(ToolSide::of(world)), options_(options) {}

  RunResult run() {
    const scene::Description& d = world_.description;
    const double duration = options_.duration_s > 0.0 ? options_.duration_s : d.duration_s;
    const double period = period_of(d);
    if (!(duration / period < 1e9))
      fail(
          "duration_s = {} makes {:.3g} exchange periods of {} s, more than can be counted; choose a shorter "
          "duration",
          duration, duration / period, period);
    const int periods = whole_number(std::ceil(duration / period - 1e-9));
    const double wall = wall_seconds(), cpu = cpu_seconds();
    if (world_.stepper) world_.stepper->set_interrupt(options_.stop);
    start_tool();
    const auto& observers = options_.observers;
    if (std::any_of(observers.begin(), observers.end(), [](const Observer* o) { return o->wants_energy(); }))
      ledger_.emplace(world_).start();
    notify_period(0.0);
    for (int i = 0; i < periods && result_.status.ok(); ++i) {
      if (options_.stop && options_.stop->load()) {
        result_.stopped = true;
        break;
      }
      const double t1 = i + 1 == periods ? duration : (i + 1) * period;
      one_period(i * period, t1);
      // ended within the period: nothing of it is kept
      if (result_.status.status == dynamics::StepStatus::kInterrupted) {
        result_.status = {};
        result_.stopped = true;
      }
      if (!result_.status.ok() || result_.stopped) break;
      ++result_.periods;
      result_.time = t1;
      notify_period(t1);
      if (ledger_) notify_energy(t1);
      if (options_.progress) options_.progress(static_cast<double>(i + 1) / periods);
    }
    result_.wall_s = wall_seconds() - wall;
    result_.cpu_s = cpu_seconds() - cpu;
    finish();
    return result_;
  }

 private:
  void one_period(double t0, double t1) {
    refresh_contact();
    // a tool feels the contact that was found before its ticks: these end where the next query is due
    for (double t = t0, next;; t = next) {
      next = side_.tool ? next_query(t, t1) : t1;
      if (side_.tool) tick_tool(t, next);
      if (!result_.status.ok()) return;
      if (world_.stepper)
        advance_state(t, next);
      else
        world_.state.set_time(next);  // a tool with ticks of its own, alone
      if (!result_.status.ok() || next >= t1) return;
      refresh_contact();
    }
  }

  /// When contact is to be looked for again: at t1, or, with tunnelling = "substep", so soon that no skin has
  /// gone farther by then into what it touches than half of its thickness (SampleSource::safe_time).
  double next_query(double t0, double t1) {
    const scene::CosimulationSpec& exchange = world_.description.exchange;
    if (!world_.contact || exchange.tunnelling != "substep") return t1;
    const double safe = world_.contact->safe_time(), rest = t1 - t0;
    const double wanted = std::ceil(rest / safe - 1e-9),
                 most = std::max(1.0, std::floor(rest / exchange.shortest_refresh_s + 1e-9));
    if (!(wanted > 1.0) || most <= 1.0) return t1;
    ++result_.sub_steps;
    result_.shortest_refreshes += wanted > most;
    return t0 + rest / std::min(wanted, most);
  }

  /// The slow query; multistep integrators then forget their history.
  void refresh_contact() {
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

  /// Bodies follow over the period, with the tool's motion known or, if monolithic, integrated with them; the
  /// contact is refreshed inside the period at whole fractions of it.
  void advance_state(double t0, double t1) {
    const double refresh = world_.contact ? world_.description.exchange.contact_refresh_s : t1 - t0;
    const int parts = whole_number((t1 - t0) / refresh);
    for (int i = 0; i < parts; ++i) {
      if (i > 0) refresh_contact();
      const double start = t0 + i * (t1 - t0) / parts,
                   end = i + 1 == parts ? t1 : t0 + (i + 1) * (t1 - t0) / parts;
      for (double t = start; t < end;) {
        if (t > start) refresh_contact();
        t = next_query(t, end);
        advance_over_changes(t);
        if (!result_.status.ok()) return;
      }
    }
  }

  /// Advances to t, stopping where a body's material changes.
  void advance_over_changes(double t) {
    for (;;) {
      const double stop = next_change();
      const bool on_the_way = stop < t * (1.0 - 1e-12);
      result_.status = ticks_ ? ticks_->advance_to(on_the_way ? stop : t)
                              : world_.stepper->advance_to(on_the_way ? stop : t);
      if (!result_.status.ok()) return;
      if (stop <= t * (1.0 + 1e-12)) change_materials(stop);
      if (!on_the_way) return;
    }
  }

  double next_change() const {
    double next = HUGE_VAL;
    for (const SoftBodySpec& spec : world_.description.bodies)
      for (const MaterialChangeSpec& change : spec.changes)
        if (change.time_s > changed_) next = std::min(next, change.time_s);
    return next;
  }

  void change_materials(double time) {
    changed_ = time;
    if (ledger_) ledger_->before_material();
    for (std::size_t i = 0; i < world_.bodies.size(); ++i)
      for (const MaterialChangeSpec& change : world_.description.bodies[i].changes)
        if (change.time_s == time)
          world_.set_youngs_modulus(world_.bodies[i], change.youngs_modulus_pa, change.region);
    if (ledger_) ledger_->after_material();
  }

  void start_tool() {
    if (!world_.description.tool) return;
    side_.handle_now = side_.handle->sample(0.0);
    if (world_.monolithic())
      ticks_.emplace(world_, [this](const TickRecord& tick) { feel(tick); });
    else
      set_trajectory_start();
  }

  void set_trajectory_start() {
    if (!side_.trajectory) return;
    side_.trajectory->clear();
    side_.trajectory->append(side_.tool->time(), side_.tool->pose(), side_.tool->twist());
  }

  void tick_tool(double t0, double t1) {
    {
      const ScopedTimer timer(result_.linearise_s);
      record_ = linearise_contact(world_, record_.version + 1, t1 - t0, result_.frozen_fallbacks);
    }
    set_trajectory_start();
    const ScopedTimer timer(result_.tool_s);
    const int ticks = whole_number((t1 - t0) / world_.description.tool->tick_s);
    const double h = (t1 - t0) / ticks;
    for (int i = 0; i < ticks && result_.status.ok(); ++i) tick(t0 + (i + 1) * h, h);
  }

  void tick(double t, double h) {
    const device::HandleSample before = side_.handle_now, now = side_.handle->sample(t);
    const dynamics::LinearisedContact record =
        side_.meets_obstacles ? with_obstacles(world_, record_) : record_;
    result_.status = side_.tool->advance(h, {before.pose, now.pose, before.twist, now.twist}, record);
    if (!result_.status.ok()) return;
    TickRecord tick;
    tick.time = t;
    tick.tool = side_.tool->pose();
    tick.tool_twist = side_.tool->twist();
    const Vec6 contact = dynamics::contact_wrench(record, t, tick.tool, tick.tool_twist);
    tick.contact = {contact.head<3>(), contact.tail<3>()};
    if (side_.trajectory) side_.trajectory->append(t, tick.tool, tick.tool_twist);
    feel(tick);
  }

  /// The wrench on the hand at a tick.
  void feel(TickRecord tick) {
    const device::HandleSample& handle = side_.handle_now = side_.handle->sample(tick.time);
    tick.handle = handle.pose;
    tick.handle_twist = handle.twist;
    tick.wanted = tool::coupling_on_hand(*world_.description.tool, {tick.tool, tick.tool_twist},
                                         {handle.pose, handle.twist});
    tick.device = side_.limiter->limit(tick.time, tick.wanted, handle.valid);
    side_.handle->feedback(tick.time, tick.device);
    ++result_.ticks;
    if (ledger_) ledger_->tick(tick.time, tick.wanted, tick.handle_twist);
    for (Observer* observer : options_.observers) observer->tick(tick);
  }

  void notify_period(double t) {
    for (Observer* observer : options_.observers) observer->period(world_, t);
  }

  void notify_energy(double t) {
    result_.energy = ledger_->period(t);
    for (Observer* observer : options_.observers) observer->energy(*result_.energy);
  }

  void finish() {
    if (world_.stepper) world_.stepper->set_interrupt(nullptr);
    if (world_.stepper) result_.counters = world_.stepper->counters();
    if (world_.contact) {
      result_.contact_queries = world_.contact->queries();
      result_.tunnelled = world_.contact->tunnelled();
    }
    if (side_.limiter) result_.limited_ticks = side_.limiter->limited_ticks();
  }

  World& world_;
  ToolSide& side_;
  const RunOptions& options_;
  RunResult result_;
  dynamics::LinearisedContact record_;
  std::optional<EnergyLedger> ledger_;    ///< where an observer wants it
  double changed_ = 0.0;                  ///< time of the last material change [s]
  std::optional<MonolithicTicks> ticks_;  ///< where tool and bodies are one system
};

}  // namespace

double period_of(const scene::Description& d) {
  if (d.tool && d.exchange.scheme != "monolithic") return d.exchange.exchange_period_s;
  if (!d.contacts.empty()) return d.exchange.contact_refresh_s;
  return d.record ? d.record->state_period_s : d.duration_s;
}

RunResult run(World& world, const RunOptions& options) {
  const workers::Count threads(world.description.integrator.threads);
  return Loop(world, options).run();
}

}  // namespace palpate::loop
