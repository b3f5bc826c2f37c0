#pragma once
#include <string>
#include <vector>

namespace palpate::loop {

/// Timing of a run in real time.
struct RealTimeResult {
  /// "SCHED_FIFO 80", or "SCHED_OTHER (reason)".
  std::string scheduling;
  int cpu = -1;           ///< Processor that the tick thread is pinned to; -1: none.
  std::string memory;     ///< "locked", or "not locked (reason)"
  double tick_s = 0.0;    ///< Length of a tick [s].
  double period_s = 0.0;  ///< Target time between two exchanges [s].

  double stall_s = 0.0;  ///< A tick that is later than this restarts the clock [s].

  /// Number of ticks and of exchanges that were timed. A run without an end keeps the timings of the last
  /// 2^20 of each only.
  long timed_ticks = 0, timed_exchanges = 0;
  std::vector<float> lateness_s;  ///< Per tick: from its due time to the wake-up of its thread [s].
  std::vector<float> work_s;      ///< Per tick: from the wake-up to the wrench on the device [s].
  /// Per exchange: from the instant that it describes to its publication; single-rate scheme, per tick: from
  /// its due time to the wrench on the device [s].
  std::vector<float> latency_s;

  long missed_ticks = 0;  ///< Late by a tick or more; they follow each other without a pause.
  /// Ticks that a longer step covered, because it began a tick or more late; single-rate scheme only.
  long skipped_ticks = 0;
  long left_out_ticks = 0;  ///< Ticks omitted where the clock was restarted.
  long stalls = 0;          ///< Gaps without a wrench beyond the watchdog's time; the force ramped in again.
  long stretched_periods = 0;  ///< Additional periods that the bodies advanced after one query.
  long dropped_periods = 0;    ///< Periods in which the bodies were held, not simulated.
  long unrecorded_ticks = 0;   ///< Ticks that did not fit into the recorder's queue.
  /// Returns the rate of the bodies, contact included [1/s].
  double exchanges_per_s() const {
    const double lasted = tick_s * (static_cast<double>(timed_ticks) + static_cast<double>(skipped_ticks));
    return lasted > 0.0 ? static_cast<double>(timed_exchanges) / lasted : 0.0;
  }
  /// Returns the simulated time in which the bodies were held [s].
  double dropped_s() const { return static_cast<double>(dropped_periods) * period_s; }
};

/// Visits the results of a run in real time by name, with the unit in it: f("tick_late_p99_s", value).
template <class F>
void visit_real_time(F&& f, const RealTimeResult& r);

/// Returns the q-quantile of the values (nearest rank); 0 if there are none.
double quantile(std::vector<float> values, double q);

template <class F>
void visit_real_time(F&& f, const RealTimeResult& r) {
  struct Series {
    const char *p50, *p99, *p999, *max;
    const std::vector<float>& values;
  };
  f("ticks_timed", static_cast<long long>(r.timed_ticks));
  f("missed_ticks", static_cast<long long>(r.missed_ticks));
  f("stalls", static_cast<long long>(r.stalls));
  f("skipped_ticks", static_cast<long long>(r.skipped_ticks));
  f("left_out_ticks", static_cast<long long>(r.left_out_ticks));
  for (const Series& s :
       {Series{"tick_late_p50_s", "tick_late_p99_s", "tick_late_p99_9_s", "tick_late_max_s", r.lateness_s},
        Series{"tick_work_p50_s", "tick_work_p99_s", "tick_work_p99_9_s", "tick_work_max_s", r.work_s},
        Series{"exchange_latency_p50_s", "exchange_latency_p99_s", "exchange_latency_p99_9_s",
               "exchange_latency_max_s", r.latency_s}}) {
    f(s.p50, quantile(s.values, 0.5));
    f(s.p99, quantile(s.values, 0.99));
    f(s.p999, quantile(s.values, 0.999));
    f(s.max, quantile(s.values, 1.0));
  }
  f("exchanges", static_cast<long long>(r.timed_exchanges));
  f("exchanges_per_s", r.exchanges_per_s());
  f("stretched_periods", static_cast<long long>(r.stretched_periods));
  f("dropped_periods", static_cast<long long>(r.dropped_periods));
  f("dropped_s", r.dropped_s());
  f("unrecorded_ticks", static_cast<long long>(r.unrecorded_ticks));
}

}  // namespace palpate::loop
