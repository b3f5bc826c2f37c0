#include "single_rate_real_time.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>
#include <vector>

#include "palpate/device/limiter.h"
#include "real_time_run.h"
#include "real_time_thread.h"
#include "single_rate.h"
#include "tick_pace.h"
#include "timing_series.h"

namespace palpate::loop {
namespace {

// One thread, by the wall clock:
//
//     due(i)   sample handle, step tools and bodies, wrench to the device
//              then, in the rest of the tick, the observers and the contact query where one is due
//
// A tick that begins after its due time is late because its predecessors took too long, or because the system
// gave the processor to others. Later steps make up for it, or a step covers several ticks (tick_pace.h): an
// implicit step of several ticks costs about as much as one of a single tick. The ticks before the last one
// of a step are skipped and counted. Beyond kFallTime (limiter.h) the clock is restarted instead, as in the
// partitioned scheme (real_time_run.cpp).
constexpr std::int64_t kStall = std::int64_t(1e9 * device::kFallTime);  // [ns]

/// Time from readiness to the first tick [ns].
constexpr std::int64_t kLead = 20'000'000;

float seconds(std::int64_t ns) { return static_cast<float>(1e-9 * static_cast<double>(ns)); }

class SingleRateRealTime {
 public:
  SingleRateRealTime(World& world, BodyLoop& bodies, const RunOptions& options, RunResult& result)
      : world_(world),
        bodies_(bodies),
        options_(options),
        result_(result),
        out_(result.real_time.emplace()),
        loops_(haptic_loops(world)),
        ticks_(world, bodies, result, pointers_to(loops_)),
        tick_s_(bodies.period() / ticks_.ticks_per_period()),
        tick_ns_(std::llround(1e9 * tick_s_)),
        count_(ticks_.count()),
        capacity_(bodies.is_endless() ? TimingSeries::kEndless : static_cast<std::size_t>(count_)),
        lateness_(out_.lateness_s, out_.timed_ticks, capacity_),
        work_(out_.work_s, work_count_, capacity_),
        latency_(out_.latency_s, out_.timed_exchanges, capacity_) {
    out_.tick_s = out_.period_s = tick_s_;
    out_.stall_s = device::kFallTime;
  }

  void run() {
    if (!await_devices(world_, options_)) {
      result_.stopped = true;
      return;
    }
    for (HapticLoop& loop : loops_) loop.start(0.0);
    bodies_.start();
    ticks_.start();
    const RealTimeClaim claim(out_, world_.description.integrator.threads);
    start_ns_ = now_ns() + kLead;
    tick_by_the_clock();
    for (HapticLoop& loop : loops_) loop.end();
    for (TimingSeries* series : {&lateness_, &work_, &latency_}) series->close();
  }

 private:
  static std::deque<HapticLoop> haptic_loops(World& world) {
    std::deque<HapticLoop> out;
    for (ToolInstance& tool : world.tools) out.emplace_back(world.description, tool);
    return out;
  }
  static std::vector<HapticLoop*> pointers_to(std::deque<HapticLoop>& loops) {
    std::vector<HapticLoop*> out;
    for (HapticLoop& loop : loops) out.push_back(&loop);
    return out;
  }

  void tick_by_the_clock() {
    std::int64_t woke_before = start_ns_;
    TickPace pace(tick_ns_, std::max(1L, kStall / tick_ns_));
    for (long done = 0; done < count_;) {
      const long next = std::min(count_, done + pace.stride());
      const bool paused = hold_while_paused();
      sleep_until_ns(start_ns_ + next * tick_ns_);
      result_.stopped = options_.stop && options_.stop->load(std::memory_order_relaxed);
      if (result_.stopped) return;
      const std::int64_t woke = now_ns(), late = woke - start_ns_ - next * tick_ns_;
      const long left_out = late > kStall ? late / tick_ns_ : 0;  // the clock is restarted
      start_ns_ += left_out * tick_ns_;
      const long last = left_out > 0 ? next : std::min(count_, next + pace.begin(late));
      ticks_.mark(woke - std::exchange(woke_before, woke) > (next - done) * tick_ns_ + kStall || paused,
                  left_out);
      ticks_.tick(ticks_.time_of(done), ticks_.time_of(last));
      if (bodies_.ended()) return;
      note(late, left_out, last - done - 1, now_ns() - woke);
      const int per_period = ticks_.ticks_per_period();
      const long before = std::exchange(done, last);
      const bool closes = done / per_period > before / per_period || done == count_;
      const double now = ticks_.time_of(done);
      if (closes) bodies_.close_period(now);
      if (done < count_) ticks_.query_if_due(now, ticks_.time_of((done / per_period + 1) * per_period));
      pace.end(now_ns() - woke);
    }
  }

  /// Waits while the run is paused, with no force on the devices; the clock then starts anew from here.
  /// Returns whether it waited.
  bool hold_while_paused() {
    if (!options_.pause || !options_.pause->load(std::memory_order_relaxed)) return false;
    for (HapticLoop& loop : loops_) loop.end();
    start_ns_ += wait_for_the_end_of_a_pause(*options_.pause,
                                             [this] { return options_.stop && options_.stop->load(); });
    return true;
  }

  void note(std::int64_t late, long left_out, long skipped, std::int64_t work) {
    lateness_.add(seconds(late));
    work_.add(seconds(work));
    latency_.add(seconds(late - left_out * tick_ns_ + work));
    for (Observer* observer : options_.observers)
      observer->timed({seconds(late), seconds(work), static_cast<std::uint32_t>(skipped),
                       static_cast<std::uint32_t>(left_out)});
    out_.missed_ticks += late >= tick_ns_;
    out_.left_out_ticks += left_out;
    out_.skipped_ticks += skipped;
    out_.stalls += left_out > 0;
  }

  World& world_;
  BodyLoop& bodies_;
  const RunOptions& options_;
  RunResult& result_;
  RealTimeResult& out_;
  std::deque<HapticLoop> loops_;
  SingleRate ticks_;
  double tick_s_;
  std::int64_t tick_ns_, start_ns_ = 0;
  long count_, work_count_ = 0;
  std::size_t capacity_;
  TimingSeries lateness_, work_, latency_;  ///< Series of `out_`.
};

}  // namespace

void run_single_rate_in_real_time(World& world, BodyLoop& bodies, const RunOptions& options,
                                  RunResult& result) {
  check_clock(world, true);
  SingleRateRealTime(world, bodies, options, result).run();
}

}  // namespace palpate::loop
