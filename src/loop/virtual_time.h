#pragma once
#include <deque>
#include <optional>

#include "body_loop.h"
#include "loop/contact_record.h"
#include "single_rate.h"
#include "tick_group.h"

namespace palpate::loop {

/// Both sides alternating in one thread: the order of all operations is fixed, so that runs are bitwise
/// reproducible.
class VirtualTime {
 public:
  /// Starts a run; observers are called for the start.
  VirtualTime(World& world, BodyLoop& bodies, const RunOptions& options, RunResult& result);
  /// Resumes from an archive, with a World that has not been advanced; observers are not called.
  VirtualTime(World& world, BodyLoop& bodies, const RunOptions& options, RunResult& result, Archive& from);
  /// Advances by one period. Returns false if no period is left, or if the period was not completed.
  bool next();
  int periods() const { return periods_; }  ///< Completed periods.
  /// Writes the state after a period. Only the constructor restores.
  void archive(Archive& a);
  /// Sets the wrenches on the hands to zero.
  void end();

 private:
  struct Coming {
    long tick;
    ContactRecord record;
  };
  struct Hand {
    Hand(const scene::Description& d, ToolInstance& tool) : tick_s(tool.spec.tick_s), haptic_loop(d, tool) {}
    double tick_s;
    HapticLoop haptic_loop;
    ContactRecord in_force;
    std::deque<Coming> coming;
    long count = 0;  ///< Number of ticks.
  };

  void make_hands();
  void one_period(double t0, double t1);
  void tick_tools(double t0, double t1);
  void tick_everything(double t1);
  void adopt(Hand& hand, const ContactRecord& record);
  /// Returns the record in force at a hand's next tick.
  const ContactRecord& record_of(Hand& hand);
  void tick(TickGroup& group, double t, double h);

  World& world_;
  BodyLoop& bodies_;
  const RunOptions& options_;
  RunResult& result_;
  int periods_ = 0;  ///< Completed periods.
  std::deque<Hand> hands_;
  std::vector<TickGroup> groups_;         ///< Groups of hands_.
  std::optional<MonolithicTicks> dense_;  ///< Monolithic scheme only.
  std::optional<SingleRate> single_;      ///< Single-rate scheme only.
};

/// Runs both sides to the end in virtual time.
void run_in_virtual_time(World& world, BodyLoop& bodies, const RunOptions& options, RunResult& result);

}  // namespace palpate::loop
