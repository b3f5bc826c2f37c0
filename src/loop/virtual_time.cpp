#include <deque>
#include <optional>

#include "body_side.h"
#include "palpate/core/clock.h"
#include "tick_side.h"

namespace palpate::loop {
namespace {

/// Both sides in one thread, by turns: the order of everything is fixed, so that every run is the same to the
/// last bit.
class VirtualTime {
 public:
  VirtualTime(World& world, BodySide& bodies, RunResult& result)
      : world_(world), bodies_(bodies), result_(result), side_(ToolSide::of(world)) {
    const scene::Description& d = world.description;
    if (!d.tool) return;
    ticks_.emplace(d, side_).start(0.0);
    if (!world.monolithic()) {
      bodies.restart_path();
      return;
    }
    dense_.emplace(world, [this](TickRecord tick) {
      ticks_->feel(tick);
      bodies_.felt(tick);
    });
    bodies.set_ticks(&*dense_);
  }

  void one_period(double t0, double t1) {
    bodies_.query();
    // a tool feels the contact that was found before its ticks: these end where the next query is due
    for (double t = t0, next;; t = next) {
      const bool exchanged = side_.tool != nullptr;
      next = exchanged ? bodies_.next_query(t, t1) : t1;
      if (exchanged) tick_tool(t, next);
      if (!result_.status.ok()) return;
      bodies_.advance(t, next, world_.description.exchange.contact_refresh_s);
      if (!result_.status.ok() || next >= t1) return;
      bodies_.query();
    }
  }

  void end() {
    if (ticks_) ticks_->end();
  }

 private:
  void tick_tool(double t0, double t1) {
    adopt(bodies_.linearise(t1 - t0));
    bodies_.restart_path();
    const ScopedTimer timer(result_.tool_s);
    const int ticks = whole_number((t1 - t0) / world_.description.tool->tick_s);
    const double h = (t1 - t0) / ticks;
    for (int i = 0; i < ticks && result_.status.ok(); ++i) tick(t0 + (i + 1) * h, h);
  }

  /// A linearisation is in force from latency_ticks on; the first of a run at once.
  void adopt(const ContactRecord& record) {
    const int latency = record.linear.version == 1 ? 0 : world_.description.exchange.latency_ticks;
    if (latency == 0)
      in_force_ = record;
    else
      coming_.push_back({count_ + latency, record});
  }

  void tick(double t, double h) {
    for (; !coming_.empty() && coming_.front().tick <= count_; coming_.pop_front())
      in_force_ = coming_.front().record;
    ++count_;
    TickRecord tick;
    result_.status = ticks_->tick(t, h, ticks_->contact(t, h, in_force_), tick);
    if (!result_.status.ok()) return;
    bodies_.follow(t, tick.tool, tick.tool_twist);
    bodies_.felt(tick);
  }

  struct Coming {
    long tick;
    ContactRecord record;
  };

  World& world_;
  BodySide& bodies_;
  RunResult& result_;
  ToolSide& side_;
  std::optional<TickSide> ticks_;
  std::optional<MonolithicTicks> dense_;  ///< where tool and bodies are one system
  ContactRecord in_force_;
  std::deque<Coming> coming_;
  long count_ = 0;  ///< of ticks
};

}  // namespace

void run_in_virtual_time(World& world, BodySide& bodies, const RunOptions& options, RunResult& result) {
  VirtualTime clock(world, bodies, result);
  bodies.start();
  for (int i = 0; i < bodies.periods(); ++i) {
    result.stopped = options.stop && options.stop->load();
    if (result.stopped) break;
    clock.one_period(bodies.period_start(i), bodies.period_start(i + 1));
    if (bodies.ended()) break;
    bodies.close_period(bodies.period_start(i + 1));
  }
  clock.end();
}

}  // namespace palpate::loop
