#pragma once
#include <optional>

#include "monolithic_ticks.h"
#include "palpate/device/buzz.h"
#include "palpate/loop/contact_record.h"
#include "palpate/loop/energy.h"
#include "palpate/loop/run.h"
#include "tool_side.h"

namespace palpate::loop {

/// The bodies' side of a run: contact queries, linearisations for the tool, steps, and what observers see of
/// them.  Of the tool it has the poses that it was told.  It owns the World while a run lasts.
class BodySide {
 public:
  BodySide(World& world, const RunOptions& options, RunResult& result);

  /// The length of the run, and of its periods [s].  @throws Error for more than can be counted
  double duration() const { return duration_; }
  double period() const { return period_; }
  int periods() const { return periods_; }
  double period_start(int i) const { return i == periods_ ? duration_ : i * period_; }

  /// At t = 0, before the first period.
  void start();
  /// The slow query at an exchange, where the tool grasps and lets go as the handle's switch says; multistep
  /// integrators then forget their history.
  void query();
  /// The contact as that hand's tool feels it for the coming `period_s`.
  ContactRecord linearise(std::size_t hand, double period_s);
  /// That hand's tool was there, at a later time than all told before; from the last restart on it is a path
  /// that the bodies follow.
  void follow(std::size_t hand, double t, const Pose& pose, const Twist& twist);
  void restart_path();  ///< of all tools
  /// That hand felt this.
  void felt(std::size_t hand, const TickRecord& tick);
  /// When contact is to be looked for again: at t1, or, with tunnelling = "substep", so soon that no skin has
  /// gone farther by then into what it touches than half of its thickness (SampleSource::safe_time).
  double next_query(double t0, double t1);
  /// Bodies go on to t1; contact is refreshed on the way at whole fractions, `refresh_s` apart, not at t0.
  void advance(double t0, double t1, double refresh_s);
  /// Stands still to t1; what a tool carries goes with it.  @pre each tool's path reaches from the State's
  /// time to its known pose
  void stand_still(double t1);
  /// The period that ends at t1 is over.
  void close_period(double t1);
  /// Whether the run has failed, or was told to stop: then nothing of this period is kept.
  bool ended();
  /// Steps go through these ticks, where tool and bodies are one system.
  void set_ticks(MonolithicTicks* ticks) { ticks_ = ticks; }
  /// What stepper, contact, limiters and devices have counted so far, into the result.
  void sum_up();
  void finish();

  /// The last query of a World that a checkpoint gives up: what went through since the one before is counted,
  /// and the balance of energy goes on from the samples that the next World begins with.
  void look_once_more();
  /// After a period.  What gives back takes the place of start(): World, ledger and counts are then as they
  /// were, the integrator begins anew, and contact has been queried at that state.
  void archive(Archive& a);

 private:
  void look();  ///< the query alone
  void advance_over_changes(double t);
  double next_change() const;
  void change_materials(double time);
  void archive_counts(Archive& a);
  void change_materials_so_far();

  World& world_;
  const RunOptions& options_;
  RunResult& result_;
  double duration_ = 0.0, period_ = 0.0;
  int periods_ = 0;
  double changed_ = 0.0;                      ///< time of the last material change [s]
  dynamics::StepperCounters counted_before_;  ///< by the steppers of Worlds that checkpoints gave up
  /// Of a hand, as scene::hands_of() counts them.
  struct Felt {
    std::uint64_t version = 0;         ///< of the last linearisation
    std::optional<device::Buzz> buzz;  ///< where ticks are fast enough
    long ticks = 0;
  };
  std::vector<Felt> felt_;
  std::optional<EnergyLedger> ledger_;  ///< where an observer wants it
  MonolithicTicks* ticks_ = nullptr;
};

/// The two clocks: each runs the sides to the end.
void run_in_virtual_time(World& world, BodySide& bodies, const RunOptions& options, RunResult& result);
void run_in_real_time(World& world, BodySide& bodies, const RunOptions& options, RunResult& result);

/// Ticks, steps or periods nearest to a ratio, at least one.
int whole_number(double ratio);

}  // namespace palpate::loop
