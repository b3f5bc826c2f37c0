#pragma once
#include <vector>

#include "body_loop.h"
#include "haptic_loop.h"

namespace palpate::loop {

/// Ticks of the single-rate scheme. A tick samples every handle, advances tools and bodies as one system to
/// the end of the tick, and sends the wrenches of that same state:
///
///     handle(t1) --> coupling in the State --> step t0 -> t1 --> wrench(tool(t1), handle(t1)) --> device
///
/// No contact record is exchanged, and nothing is linearised or reduced for the tools; what a hand feels is
/// one tick old.
class SingleRate {
 public:
  /// @param loops  one per hand, in the numbering of scene::hands_of(); all must outlive this object
  SingleRate(World& world, BodyLoop& bodies, const RunResult& result, std::vector<HapticLoop*> loops);
  /// Returns the number of ticks per period of contact queries.
  int ticks_per_period() const { return per_period_; }
  /// Returns the number of ticks of the run; the last period may have fewer than the others.
  long count() const { return count_; }
  /// Returns the end of a tick, counted from 1 [s].
  double time_of(long tick) const;
  /// Makes the first contact query of a run and prepares the stepper, after BodyLoop::start().
  void start();
  /// Queries contact where it is due at time t: at the start of a period, and with tunnelling = "substep"
  /// when a skin may otherwise penetrate too deep (BodyLoop::next_query).
  /// @param period_end  end of the period of contact queries that t belongs to [s]
  void query_if_due(double t, double period_end);
  /// Advances by one tick from t0 to t1 [s]. Stops where the step fails, with the status in the result.
  /// @pre query_if_due() was called for t0
  void tick(double t0, double t1);
  /// Sets properties of the records of the next tick, in real time.
  void mark(bool ramps_in, long left_out);

 private:
  World& world_;
  BodyLoop& bodies_;
  const RunResult& result_;
  std::vector<HapticLoop*> loops_;
  int per_period_;
  double tick_s_;
  long count_;
  double next_query_ = 0.0;  ///< [s]
  long left_out_ = 0;
};

}  // namespace palpate::loop
