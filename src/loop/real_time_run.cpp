#include "real_time_run.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <exception>
#include <latch>
#include <thread>
#include <utility>

#include "core/clock.h"
#include "core/spsc_ring.h"
#include "loop/contact_record.h"
#include "palpate/core/error.h"
#include "palpate/core/triple_buffer.h"
#include "palpate/device/limiter.h"
#include "real_time_thread.h"
#include "tick_group.h"
#include "timing_series.h"

namespace palpate::loop {
namespace {

// Two threads. The tick thread wakes every tick_s by the wall clock: device, newest contact record, tool,
// wrench. The thread of the bodies follows one period later:
//
//     ticks   |.........t.........|.........t+P.......|.........t+2P
//     bodies            | x(t-P) -> x(t), query, linearise at t
//                                 | x(t) -> x(t+P), query, linearise at t+P
//
// After the ticks of [t, t+P], the tool's path in it is known, and the step of the bodies over it is the same
// as in virtual time. The record for time t+P reaches the ticks after its computation; F1 and J extrapolate
// it to their time. Virtual time models this delay with latency_ticks.
//
// Bodies that are late advance by two to kStretched periods after one query (a query costs more than a step).
// In periods beyond that they are held, so that the contact that the hand receives is never older than that.
// A step that is not complete by then, counted from the last tick, is interrupted, so that the run ends on
// time.
constexpr int kStretched = 4;

// A late tick follows the one before at once, until the ticks have caught up with the clock. Beyond kFallTime
// (limiter.h) a device without a pose has lost its force, and a hand that waited for a wrench for so long is
// far from the tool: the ticks up to then are omitted, and the clock is restarted.
constexpr std::int64_t kStall = std::int64_t(1e9 * device::kFallTime);  // [ns]

/// Capacity of the queue of ticks to the bodies' thread: 16 s at 1 kHz.
constexpr std::size_t kQueue = 1 << 14;
/// Time from readiness of both threads to the first tick [ns].
constexpr std::int64_t kLead = 20'000'000;

struct TimedTick {
  TickRecord record;
  std::size_t hand = 0;
  long number = 0;  ///< From 1, equal for all hands.
  float lateness_s = 0.0F, work_s = 0.0F;
};

float seconds(std::int64_t ns) { return static_cast<float>(1e-9 * static_cast<double>(ns)); }

std::size_t capacity_of(const BodyLoop& bodies, long count) {
  return bodies.is_endless() ? TimingSeries::kEndless : static_cast<std::size_t>(count);
}

class RealTime {
 public:
  RealTime(World& world, BodyLoop& bodies, const RunOptions& options, RunResult& result)
      : world_(world),
        bodies_(bodies),
        options_(options),
        result_(result),
        out_(result.real_time.emplace()),
        per_period_(whole_number(bodies.period() / world.description.tool->tick_s)),
        tick_s_(bodies.period() / per_period_),
        tick_ns_(std::llround(1e9 * tick_s_)),
        count_(static_cast<long>(per_period_) * bodies.periods()),
        lateness_(out_.lateness_s, out_.timed_ticks, capacity_of(bodies, count_)),
        work_(out_.work_s, work_count_, capacity_of(bodies, count_)),
        latency_(out_.latency_s, out_.timed_exchanges, capacity_of(bodies, bodies.periods())),
        queue_(kQueue) {
    for (ToolInstance& tool : world.tools) hands_.emplace_back(world.description, tool);
    groups_ = TickGroup::all(hands_);
    contact_of_.resize(hands_.size());
    for (const TickGroup& group : groups_)
      for (std::size_t i = 0; i < group.members().size(); ++i)
        contact_of_[group.members()[i].hand] = &group.contact(i);
    out_.tick_s = tick_s_;
    out_.period_s = bodies.period();
    out_.stall_s = device::kFallTime;
  }

  /// Restores the stepper's interrupt flag, as the stepper outlives the run.
  ~RealTime() {
    if (world_.stepper) world_.stepper->set_interrupt(options_.stop);
  }
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  void run() {
    if (!await_devices(world_, options_)) {
      result_.stopped = true;
      return;
    }
    for (Hand& hand : hands_) hand.haptic_loop.start(0.0);
    bodies_.restart_path();
    bodies_.start();
    if (world_.stepper) world_.stepper->set_interrupt(&interrupt_);
    bodies_.query();
    publish();
    if (world_.stepper) world_.stepper->prepare(bodies_.period());
    for (ToolInstance& tool : world_.tools)
      if (const auto& reduction = tool.partitioned()->reduction)
        reduction->prepare(world_.state, bodies_.period());
    std::thread thread([this] { tick_to_the_end(); });
    ready_.wait();
    try {
      while (done_ < count_ && one_step()) {}
    } catch (...) {
      quit_.store(true);
      thread.join();
      throw;
    }
    quit_.store(true);
    thread.join();
    stop_requested();
    drain(ticked_.load());
    for (TimingSeries* series : {&lateness_, &work_, &latency_}) series->close();
    if (failure_) std::rethrow_exception(failure_);
    if (result_.status.ok()) result_.status = tick_status_;
    out_.unrecorded_ticks = unrecorded_.load();
    for (const float work : out_.work_s) result_.tool_s += work;
    release_memory();
  }

 private:
  // --- Tick thread: it allocates no memory, and waits only for the clock

  void tick_to_the_end() {
    // Locking all memory blocks allocations for a while, so the clock starts afterwards.
    claim_real_time(out_);
    start_ns_ = now_ns() + kLead;
    ready_.count_down();
    try {
      tick_by_the_clock();
    } catch (...) { failure_ = std::current_exception(); }
    for (Hand& hand : hands_) try {
        hand.haptic_loop.end();
      } catch (...) {
        if (!failure_) failure_ = std::current_exception();
      }
    const bool to_the_end = ticked_.load() == count_;
    over_.store(true, std::memory_order_release);
    const std::int64_t patience = to_the_end ? kStretched * per_period_ * tick_ns_ : 0;
    for (const std::int64_t end = now_ns() + patience; !quit_.load() && now_ns() < end;)
      sleep_until_ns(std::min(end, now_ns() + 1'000'000));
    interrupt_.store(true);
  }

  void tick_by_the_clock() {
    TimedTick timed;
    std::int64_t woke_before = start_ns_;
    for (long i = 1; i <= count_ && !quit_.load(std::memory_order_relaxed); ++i) {
      const bool paused = hold_while_paused();
      sleep_until_ns(start_ns_ + i * tick_ns_);
      if (options_.stop && options_.stop->load(std::memory_order_relaxed)) return;
      const std::int64_t woke = now_ns(), late = woke - start_ns_ - i * tick_ns_;
      const long left_out = late > kStall ? late / tick_ns_ : 0;
      start_ns_ += left_out * tick_ns_;
      const bool ramps_in = woke - std::exchange(woke_before, woke) > tick_ns_ + kStall || paused;
      const double t = static_cast<double>(i) * tick_s_;
      timed.number = i;
      timed.lateness_s = seconds(late);
      for (TickGroup& group : groups_)
        group.find_contact(t, tick_s_, [this](std::size_t hand) -> const ContactRecord& {
          return hands_[hand].records.latest();
        });
      for (timed.hand = 0; timed.hand < hands_.size(); ++timed.hand) {
        HapticLoop& haptic_loop = hands_[timed.hand].haptic_loop;
        if (ramps_in) haptic_loop.ramp_in();
        tick_status_ = haptic_loop.tick(t, tick_s_, *contact_of_[timed.hand], timed.record);
        if (!tick_status_.ok()) return;
        timed.record.left_out = static_cast<std::uint32_t>(left_out);
        timed.work_s = seconds(now_ns() - woke);  // for the last hand, the time of all hands
        if (!queue_.push(timed)) unrecorded_.fetch_add(1, std::memory_order_relaxed);
      }
      ticked_.store(i, std::memory_order_release);
    }
  }

  /// Waits while the run is paused, with no force on the devices; the clock then starts anew from here.
  /// Returns whether it waited.
  bool hold_while_paused() {
    if (!options_.pause || !options_.pause->load(std::memory_order_relaxed)) return false;
    for (Hand& hand : hands_) hand.haptic_loop.end();
    start_ns_ += wait_for_the_end_of_a_pause(*options_.pause, [this] {
      return quit_.load(std::memory_order_relaxed) || (options_.stop && options_.stop->load());
    });
    return true;
  }

  // --- Thread of the bodies

  /// Makes one exchange: waits for the ticks of a period, follows them, and publishes. Returns false at the
  /// end of the run.
  bool one_step() {
    const long requested = done_ + per_period_;
    if (stop_requested()) return false;
    sleep_until_ns(start_ns_ + requested * tick_ns_);
    long ticked = 0;
    for (bool over = false; (ticked = ticked_.load(std::memory_order_acquire)) < requested;) {
      if (over) return false;
      over = over_.load(std::memory_order_acquire);
      if (stop_requested()) return false;
      const bool paused = options_.pause && options_.pause->load(std::memory_order_relaxed);
      sleep_until_ns(now_ns() + (paused ? 2'000'000 : 20'000));
    }
    if (interrupt_.load()) {
      if (!stop_requested()) give_up_steps(done_);
      return false;
    }
    const long behind = (ticked - done_) / per_period_;
    const long dropped = std::max(0L, behind - kStretched), taken = behind - dropped;
    if (dropped > 0) hold_bodies(dropped);
    const long from = done_;
    advance(taken);
    if (result_.status.status == dynamics::StepStatus::kInterrupted && !stop_requested()) {
      result_.status = {};
      give_up_steps(from);
      return false;
    }
    if (bodies_.ended()) return false;
    bodies_.query();
    publish();
    latency_.add(seconds(now_ns() - start_ns_ - done_ * tick_ns_));
    bodies_.close_period(time_of(done_));
    return true;
  }

  void publish() {
    for (std::size_t i = 0; i < hands_.size(); ++i)
      hands_[i].records.publish(bodies_.linearise(i, bodies_.period()));
  }

  bool stop_requested() {
    result_.stopped = options_.stop && options_.stop->load();
    return result_.stopped;
  }

  double time_of(long tick) const { return static_cast<double>(tick) * tick_s_; }

  /// Ends a run whose last step was interrupted: the bodies are held from tick `from` on.
  void give_up_steps(long from) {
    done_ = ticked_.load() / per_period_ * per_period_;
    if (done_ <= from) return;
    out_.dropped_periods += (done_ - from) / per_period_;
    drain(done_);
    bodies_.hold_bodies(time_of(done_));
    bodies_.close_period(time_of(done_));
  }

  void hold_bodies(long periods) {
    out_.dropped_periods += periods;
    done_ += periods * per_period_;
    drain(done_);
    bodies_.hold_bodies(time_of(done_));
    bodies_.restart_path();
    bodies_.query();
  }

  void advance(long periods) {
    out_.stretched_periods += periods - 1;
    const double t0 = time_of(done_);
    bodies_.restart_path();
    done_ += periods * per_period_;
    drain(done_);
    const double t1 = time_of(done_);
    bodies_.advance(t0, t1, periods > 1 ? t1 - t0 : world_.description.exchange.contact_refresh_s);
  }

  /// Reads the ticks up to number `last` of all hands from the queue.
  void drain(long last) {
    const long all = last * static_cast<long>(hands_.size());
    for (TimedTick timed; drained_ < all && queue_.pop(timed);) {
      drained_ = (timed.number - 1) * static_cast<long>(hands_.size()) + static_cast<long>(timed.hand) + 1;
      bodies_.follow(timed.hand, timed.record.time, timed.record.tool, timed.record.tool_twist);
      bodies_.record_tick(timed.hand, timed.record);
      if (timed.hand + 1 < hands_.size()) continue;
      lateness_.add(timed.lateness_s);
      work_.add(timed.work_s);
      for (Observer* observer : options_.observers)
        observer->timed({timed.lateness_s, timed.work_s, 0, timed.record.left_out});
      out_.missed_ticks += timed.lateness_s >= static_cast<float>(tick_s_);
      out_.left_out_ticks += timed.record.left_out;
      out_.stalls += timed.record.ramps_in;
    }
  }

  struct Hand {
    Hand(const scene::Description& d, ToolInstance& tool) : haptic_loop(d, tool) {}
    HapticLoop haptic_loop;
    TripleBuffer<ContactRecord> records;
  };

  World& world_;
  BodyLoop& bodies_;
  const RunOptions& options_;
  RunResult& result_;
  RealTimeResult& out_;
  std::deque<Hand> hands_;
  std::vector<TickGroup> groups_;                               ///< Groups of hands_.
  std::vector<const dynamics::LinearisedContact*> contact_of_;  ///< Per hand, in its group.
  int per_period_;
  double tick_s_;
  std::int64_t tick_ns_;
  std::atomic<std::int64_t> start_ns_{0};  ///< Start of the clock: changed by the tick thread.
  long count_, done_ = 0, drained_ = 0, work_count_ = 0;

  TimingSeries lateness_, work_, latency_;  ///< Series of `out_`.
  SpscRing<TimedTick> queue_;
  dynamics::StepResult tick_status_;  ///< Status in the tick thread; read after its end.
  std::atomic<long> ticked_{0}, unrecorded_{0};
  std::atomic<bool> quit_{false}, over_{false};
  std::atomic<bool> interrupt_{false};  ///< Interrupts the bodies' step at the end of the run.
  std::latch ready_{1};                 ///< `start_ns_` is set
  std::exception_ptr failure_;          ///< Exception in the tick thread.
};

}  // namespace

bool await_devices(World& world, const RunOptions& options) {
  for (ToolInstance& tool : world.tools) {
    tool.device->open();
    const std::string awaited = tool.device->awaited();
    if (awaited.empty()) continue;
    if (options.waiting) options.waiting(awaited);
    tool.device->await(0.0, options.stop);
    if (options.stop && options.stop->load()) return false;
  }
  return true;
}

void run_in_real_time(World& world, BodyLoop& bodies, const RunOptions& options, RunResult& result) {
  check_clock(world, true);
  RealTime(world, bodies, options, result).run();
}

}  // namespace palpate::loop
