#pragma once
#include <string>
#include <vector>

namespace palpate::loop {

/// What a run in real time says of its own clock.
struct RealTimeResult {
  /// "SCHED_FIFO 80", or "SCHED_OTHER (why not SCHED_FIFO)"
  std::string scheduling;
  int cpu = -1;           ///< that the ticks' thread is pinned to; -1: to none
  std::string memory;     ///< "locked", or "not locked (why)"
  double tick_s = 0.0;    ///< [s]
  double period_s = 0.0;  ///< wanted time between two exchanges [s]

  double stall_s = 0.0;  ///< beyond it a tick that is late starts the clock anew [s]

  std::vector<float> lateness_s;  ///< of each tick: from when it was due to when its thread woke [s]
  std::vector<float> work_s;      ///< of each tick: from there to the wrench on the device [s]
  /// of each exchange: from the instant that it describes to its publication [s]
  std::vector<float> latency_s;

  long missed_ticks = 0;       ///< late by a tick or more: they follow each other without a pause
  long left_out_ticks = 0;     ///< of the clock, where they were too late: it started anew behind them
  long stalls = 0;             ///< longer than the watchdog's, without a wrench: the force set in anew
  long stretched_periods = 0;  ///< in which the bodies advanced by several periods after one query
  long dropped_periods = 0;    ///< that the bodies did not simulate: they stand still in them
  long unrecorded_ticks = 0;   ///< that did not fit the queue to the recorder
  /// Rate of the bodies, contact included [1/s].
  double exchanges_per_s() const {
    const double lasted = tick_s * static_cast<double>(lateness_s.size());
    return lasted > 0.0 ? static_cast<double>(latency_s.size()) / lasted : 0.0;
  }
  /// Simulated time that the bodies stood still in [s].
  double dropped_s() const { return static_cast<double>(dropped_periods) * period_s; }
};

/// Visits the figures of a run in real time by name, units in it: f("tick_late_p99_s", value).
template <class F>
void visit_real_time(F&& f, const RealTimeResult& r);

/// Value below which a share `q` of the values lies (nearest rank); 0 of none.
double quantile(std::vector<float> values, double q);

template <class F>
void visit_real_time(F&& f, const RealTimeResult& r) {
  struct Series {
    const char *p50, *p99, *p999, *max;
    const std::vector<float>& values;
  };
  f("ticks_timed", static_cast<long long>(r.lateness_s.size()));
  f("missed_ticks", static_cast<long long>(r.missed_ticks));
  f("stalls", static_cast<long long>(r.stalls));
  f("left_out_ticks", static_cast<long long>(r.left_out_ticks));
  for (const Series& s :
       {Series{"tick_late_p50_s", "tick_late_p99_s", "tick_late_p99.9_s", "tick_late_max_s", r.lateness_s},
        Series{"tick_work_p50_s", "tick_work_p99_s", "tick_work_p99.9_s", "tick_work_max_s", r.work_s},
        Series{"exchange_latency_p50_s", "exchange_latency_p99_s", "exchange_latency_p99.9_s",
               "exchange_latency_max_s", r.latency_s}}) {
    f(s.p50, quantile(s.values, 0.5));
    f(s.p99, quantile(s.values, 0.99));
    f(s.p999, quantile(s.values, 0.999));
    f(s.max, quantile(s.values, 1.0));
  }
  f("exchanges", static_cast<long long>(r.latency_s.size()));
  f("exchanges_per_s", r.exchanges_per_s());
  f("stretched_periods", static_cast<long long>(r.stretched_periods));
  f("dropped_periods", static_cast<long long>(r.dropped_periods));
  f("dropped_s", r.dropped_s());
  f("unrecorded_ticks", static_cast<long long>(r.unrecorded_ticks));
}

}  // namespace palpate::loop
