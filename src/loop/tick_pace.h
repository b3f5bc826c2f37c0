#pragma once
#include <cstdint>

namespace palpate::loop {

/// Number of ticks that each step of the single-rate scheme covers in real time.
///
/// A late tick may be made up for in two ways: by a longer step, which skips ticks, or by the next steps,
/// each of which takes less than its ticks where the loop keeps up on average. A step of another length needs
/// a new step matrix, and the step after it yet another one, which makes the loop later still. So a loop that
/// is less than kMostBehind ticks late keeps its length of step: no tick is skipped, and each wrench belongs
/// to a handle sampled when it is computed. A loop that is later either
///
///     does not keep up: the mean work of a step exceeds kMostLoad of its ticks. All further steps cover so
///         many ticks that it does not. After kCalm steps they cover one tick less, if the mean work of these
///         steps, which cost no less than shorter ones, is within kMostLoad of that; or
///     was interrupted: one step covers all ticks that are due.
///
/// All times in nanoseconds.
class TickPace {
 public:
  static constexpr long kMostBehind = 4, kCalm = 256;
  static constexpr double kMostLoad = 0.9;  ///< Largest share of its ticks that a step may take on average.

  /// @param tick_ns  length of a tick
  /// @param most  largest number of ticks per step
  TickPace(std::int64_t tick_ns, long most) : tick_ns_(tick_ns), most_(most) {}

  /// Returns the number of ticks of each step.
  long stride() const { return stride_; }
  /// Begins a step whose last tick, `stride()` ticks after the previous step, was due `late_ns` ago. Returns
  /// the number of ticks that the step covers in addition.
  long begin(std::int64_t late_ns);
  /// Records the time that a step and the work around it took.
  void end(std::int64_t work_ns);
  /// Returns the mean work of the last steps.
  double mean_work_ns() const { return mean_ns_; }

 private:
  void change_to(long stride);

  std::int64_t tick_ns_;
  long most_, stride_ = 1, since_change_ = 0;
  double mean_ns_ = 0.0;
};

}  // namespace palpate::loop
