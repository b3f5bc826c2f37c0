#pragma once
#include <optional>

#include "device/buzz.h"
#include "loop/contact_record.h"
#include "loop/energy.h"
#include "monolithic_ticks.h"
#include "palpate/loop/observer.h"
#include "palpate/loop/run_options.h"
#include "palpate/loop/run_result.h"
#include "palpate/loop/world.h"
#include "tool_instance.h"

namespace palpate::loop {

/// Bodies' side of a run: contact queries, linearisations for the tool, steps, and calls of the observers.
/// Its only information about the tools is the poses passed to follow(). It owns the World's state during a
/// run.
class BodyLoop {
 public:
  BodyLoop(World& world, const RunOptions& options, RunResult& result);

  /// Duration of the run, length and number of its periods [s]. The constructor throws Error for too many
  /// periods. A run without an end has as many periods as an int can count: 24 days at 1 kHz.
  double duration() const { return duration_; }
  bool is_endless() const { return endless_; }
  double period() const { return period_; }
  int periods() const { return periods_; }
  double period_start(int i) const { return i == periods_ ? duration_ : i * period_; }

  /// Starts at t = 0, before the first period.
  void start();
  /// Queries contact at an exchange, after grasping or releasing according to the handle's switch; multistep
  /// integrators restart.
  void query();
  /// Returns the contact record for that hand's tool, for the next `period_s` seconds.
  ContactRecord linearise(std::size_t hand, double period_s);
  /// Appends a pose of that hand's tool, later than all before. From the last restart_path() on, the poses
  /// form a path that the bodies follow.
  void follow(std::size_t hand, double t, const Pose& pose, const Twist& twist);
  void restart_path();  ///< Restarts the paths of all tools.
  /// Records one tick of that hand, and passes it to the observers.
  void record_tick(std::size_t hand, const TickRecord& tick);
  /// Returns the time of the next contact query: t1, or, with tunnelling = "substep", early enough that no
  /// skin penetrates by more than half of the other side's thickness until then (SourceReport::safe_time).
  double next_query(double t0, double t1);
  /// Advances the bodies to t1; contact is refreshed at equal fractions, about `refresh_s` apart, not at t0.
  void advance(double t0, double t1, double refresh_s);
  /// Advances the time to t1 with the bodies at rest; nodes that a tool carries move with it. @pre each
  /// tool's path reaches from the State's time to its last known pose
  void hold_bodies(double t1);
  /// Completes the period that ends at t1.
  void close_period(double t1);
  /// Returns whether the run has failed or was stopped; results of this period are then not kept.
  bool ended();
  /// Routes steps through these ticks, for the monolithic scheme.
  void set_ticks(MonolithicTicks* ticks) { monolithic_ticks_ = ticks; }
  /// Copies the counters of stepper, contact, limiters and devices to the result.
  void sum_up();
  void finish();

  /// Makes the last query of a World before a checkpoint destroys it: counts the tunnelled vertices since the
  /// query before, and continues the energy balance with the samples that the next World starts from.
  void query_before_checkpoint();
  /// Writes or restores the state after a period. Restoring replaces start(): World, ledger and counters are
  /// restored, the integrator restarts, and contact has been queried at that state.
  void archive(Archive& a);

 private:
  void query_contact();  ///< Contact query without grasping.
  void advance_over_changes(double t);
  double next_change() const;
  void change_materials(double time);
  void archive_counts(Archive& a);
  void change_materials_so_far();

  World& world_;
  const RunOptions& options_;
  RunResult& result_;
  double duration_ = 0.0, period_ = 0.0;
  bool endless_ = false;
  int periods_ = 0;
  double changed_ = 0.0;                      ///< Time of the last material change [s].
  dynamics::StepperCounters counted_before_;  ///< By steppers of Worlds before the last checkpoint.
  /// Data per hand, in the numbering of scene::hands_of().
  struct HandTicks {
    std::uint64_t version = 0;                        ///< Version of the last linearisation.
    std::optional<device::VibrationMeter> vibration;  ///< Only for sufficiently short ticks.
    long ticks = 0;
  };
  std::vector<HandTicks> hand_ticks_;
  std::optional<EnergyLedger> ledger_;  ///< Only if an observer requests it.
  MonolithicTicks* monolithic_ticks_ = nullptr;
};

/// Returns the whole number of ticks, steps or periods nearest to a ratio, at least one.
int whole_number(double ratio);

}  // namespace palpate::loop
