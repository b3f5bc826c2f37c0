#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "palpate/core/archive.h"
#include "palpate/device/passivity.h"
#include "palpate/loop/energy_balance.h"
#include "palpate/loop/real_time.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

struct ContactRecord;

/// One haptic tick as it happened.
struct TickRecord {
  double time = 0.0;               ///< at the tick's end [s]
  double length = 0.0;             ///< of the tick; 0 where the tool has no ticks of its own [s]
  Pose handle, tool;               ///< of the hand's handle and of the tool at the tick's end, world axes
  Twist handle_twist, tool_twist;  ///< of the same two
  /// on the tool: from the linearised contact, or, monolithic, from the contact itself
  Wrench contact;
  Wrench wanted;  ///< on the hand, before the limit
  /// on the hand, as sent to the motors: behind the limit and the passivity controller
  Wrench device;
  /// on the hand, as its motors held it over the tick that ends here (device/motors.h): its mean
  Wrench motors;
  bool handle_valid = true;          ///< whether the handle's pose was
  bool limited = false;              ///< the wrench wanted was above the device's maximum
  bool ramps_in = false;             ///< the force sets in anew: no wrench was sent for too long before
  std::uint32_t left_out = 0;        ///< ticks of the machine's clock that were left out before this one
  std::uint32_t switches = 0;        ///< of the handle: bit i is 1 where switch i is pressed
  std::uint64_t record_version = 0;  ///< of the contact record that this tick used; 0: none
};

/// Observes a run from outside; whatever keeps something of it implements this.
class Observer {
 public:
  virtual ~Observer() = default;
  /// At the start and after every period.
  virtual void period(World&, double /*t*/) {}
  /// Of the first hand.
  virtual void tick(const TickRecord&) {}
  /// A tick of any hand, as scene::hands_of() counts them.  What does not ask for it sees those of the first.
  virtual void tick_of(std::size_t hand, const TickRecord& tick_record) {
    if (hand == 0) tick(tick_record);
  }
  /// A record of the contact was made for the coming ticks of the first hand.
  virtual void exchanged(const ContactRecord&) {}
  /// Likewise for those of any hand.  What does not ask for it sees those of the first.
  virtual void exchanged_of(std::size_t hand, const ContactRecord& record) {
    if (hand == 0) exchanged(record);
  }
  /// After every contact query, at its state: behind `period` where both come at one time.
  virtual void queried(World&, double /*t*/) {}
  /// After every period, in runs of which an observer wants it: a run that nobody asks keeps no balance.
  virtual bool wants_energy() const { return false; }
  /// What it needs to go on in another process, or in another World, after a period.  What gives back takes
  /// the place of period(0).
  virtual void archive(Archive&) {}
  /// The balance at the period's end.
  virtual void energy(const EnergyBalance&) {}
};

/// How a run is made; a default is the scene's, or none.
struct RunOptions {
  double duration_s = 0.0;  ///< 0: the scene's
  /// ticks by the machine's clock, in a thread of their own; else in virtual time
  bool real_time = false;
  /// whether the energy at the device is counted, or also made up for
  device::PassivityController::Mode passivity = device::PassivityController::Mode::kOff;
  std::vector<Observer*> observers;               ///< called in their order; they outlive the run
  std::function<void(double fraction)> progress;  ///< called after every period
  const std::atomic<bool>* stop = nullptr;        ///< set from outside: the run ends after the current step
  /// called where the run has to wait for a device, with what for
  std::function<void(const std::string& awaited)> waiting;
};

/// The energy at the device's port over a run (device/passivity.h) [J].
struct PortEnergy {
  double energy = 0.0, least = 0.0;                ///< that the hand has put in: at the end, and at its least
  double work = 0.0, controller_dissipated = 0.0;  ///< magnitude of the motors' work, part of the controller
  long controller_ticks = 0;                       ///< in which it acted
};

/// What a run keeps of each further hand; of the first it stands in the RunResult itself.
struct HandResult {
  long ticks = 0;                  ///< of its tool
  long limited_ticks = 0;          ///< in which the device's limit held the wrench
  long outside_ticks = 0;          ///< with the handle outside the device's workspace
  long rejected_ticks = 0;         ///< whose wrench or time was not finite: forces fall to zero
  std::optional<PortEnergy> port;  ///< where passivity is observed or controlled
  std::optional<double> buzz_n;    ///< force on the hand above 30 Hz, RMS [N]
};

/// What a run did: where it ended, what it cost, what it counted.
struct RunResult {
  dynamics::StepResult status;          ///< not ok: the integrator gave up; what was recorded stands
  bool stopped = false;                 ///< `RunOptions::stop` was set
  double time = 0.0;                    ///< reached [s]
  double cpu_s = 0.0, wall_s = 0.0;     ///< of the loop, assembly left out
  double query_s = 0.0;                 ///< wall time in contact queries
  double linearise_s = 0.0;             ///< wall time in linearising contact for the tool
  double tool_s = 0.0;                  ///< wall time in the tool's ticks
  long periods = 0;                     ///< of the loop
  long ticks = 0;                       ///< of the first hand's tool
  long contact_queries = 0;             ///< refreshes of all pairs together
  long limited_ticks = 0;               ///< in which the device's limit held the wrench
  long outside_ticks = 0;               ///< with the handle outside the device's workspace, where forces fade
  long rejected_ticks = 0;              ///< whose wrench or time was not finite: forces fall to zero
  std::vector<long> tunnelled;          ///< vertices that went through unseen, for each [[contact]]
  std::optional<EnergyBalance> energy;  ///< at the end, where an observer wanted it
  long sub_steps = 0;                   ///< contact queries that tunnelling = "substep" made besides
  long shortest_refreshes = 0;  ///< of these, the ones that shortest_refresh_s made later than they were due
  long frozen_fallbacks = 0;    ///< condensed linearisations that had no factor and were frozen instead
  dynamics::StepperCounters counters;       ///< of the integrator
  std::optional<RealTimeResult> real_time;  ///< of the clock, where ticks went by it
  std::optional<PortEnergy> port;           ///< where passivity is observed or controlled
  std::optional<double> buzz_n;  ///< force on the hand above 30 Hz, RMS [N]; with a tool of fast enough ticks
  std::vector<HandResult> more_hands;  ///< of each [[hand]]
};

/// Visits every number of a run, as its overload for StepperCounters (dynamics/stepper.h), which it includes.
template <class F, class... Result>
requires(std::same_as<std::remove_const_t<Result>, RunResult>&&...) constexpr void visit_counters(
    F&& f, Result&... r) {
  f("simulated_s", r.time...);
  f("loop_cpu_s", r.cpu_s...);
  f("loop_wall_s", r.wall_s...);
  f("contact_query_s", r.query_s...);
  f("linearise_s", r.linearise_s...);
  f("tool_ticks_s", r.tool_s...);
  f("periods", r.periods...);
  f("ticks", r.ticks...);
  f("contact_queries", r.contact_queries...);
  f("limited_ticks", r.limited_ticks...);
  f("ticks_outside_workspace", r.outside_ticks...);
  f("rejected_ticks", r.rejected_ticks...);
  f("frozen_fallbacks", r.frozen_fallbacks...);
  f("sub_steps", r.sub_steps...);
  f("shortest_refreshes", r.shortest_refreshes...);
  dynamics::visit_counters(f, r.counters...);
}

/// Runs in virtual time: one exchange period after the other, ticks interleaved (docs/design.md, 1); if
/// monolithic, one refresh after the other, ticks from dense output.  A scene without a tool has periods but
/// no ticks.  Or in real time: ticks by the machine's clock in a thread of their own, bodies behind them.
/// It works on the World's own number of threads (integrator.threads), whatever other Worlds have.
/// @throws Error as check_clock(), and in real time for a device that does not come
RunResult run(World& world, const RunOptions& options);

/// Refuses what a run cannot serve by that clock, before anything is written.
/// @throws Error in real time for a scene without a tool of ticks, or with hands of different tick_s; in
///   virtual time for a device that somebody moves by the wall's clock
void check_clock(const World& world, bool real_time);

/// The length of the loop's period for a scene [s]: the exchange period where there is an exchange, else the
/// contact refresh, else the record's.
double period_of(const scene::Description& description);

}  // namespace palpate::loop
