#pragma once
#include <array>
#include <cstdint>

namespace palpate::live {

/// Distribution of times of ticks, with a relative resolution of 7 %, from 100 ns to 10 s. Adding allocates
/// nothing.
class TimeHistogram {
 public:
  void add(double seconds);
  /// Returns the q-quantile (nearest rank), the geometric mean of its interval [s]; 0 if it is empty or the
  /// quantile is below 100 ns.
  double quantile(double q) const;
  long count() const { return count_; }
  void clear() { *this = {}; }

 private:
  static constexpr int kPerDecade = 32, kDecades = 8;
  static constexpr double kLeast = 1e-7;
  std::array<std::uint32_t, kPerDecade * kDecades + 1> counts_{};
  long count_ = 0;
};

/// Figures of a run for its viewers.
struct LiveStatus {
  double time_s = 0.0;      ///< Simulated time.
  double rate_hz = 0.0;     ///< Ticks per second of wall time, over the last second.
  double late_share = 0.0;  ///< Share of these ticks that were late by a tick or more.
  double late_p99_s = 0.0;  ///< Lateness, over the last second.
  double work_p50_s = 0.0, work_p99_s = 0.0;
  double energy_j = 0.0;             ///< Kinetic and potential energy of bodies and contact.
  double port_energy_j = 0.0;        ///< Energy that the hands have put in.
  double least_port_energy_j = 0.0;  ///< Its minimum since the start.
  std::int64_t skipped_ticks = 0;    ///< Since the start of the run.
  bool has_energy = false;
};

/// Timing of ticks in windows of one second of wall time.
class TimingWindow {
 public:
  explicit TimingWindow(double tick_s) : tick_s_(tick_s) {}
  /// Adds a tick.  @param now_s  wall clock  @param skipped  ticks that this one covers in addition
  void add(double now_s, double late_s, double work_s, std::int64_t skipped);
  /// Writes the figures of the last complete window.
  void write(LiveStatus& status) const;

 private:
  double tick_s_, start_s_ = -1.0;
  TimeHistogram late_, work_;
  long late_ticks_ = 0;
  LiveStatus last_;
};

}  // namespace palpate::live
