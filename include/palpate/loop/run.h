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

/// Record of one haptic tick.
struct TickRecord {
  double time = 0.0;               ///< End of the tick [s].
  double length = 0.0;             ///< Length of the tick; 0 if the tool has no separate ticks [s].
  Pose handle, tool;               ///< Poses at the end of the tick, world axes.
  Twist handle_twist, tool_twist;  ///< Twists of handle and tool.
  /// Wrench on the tool: from the linearised contact, or, if monolithic, from the contact itself.
  Wrench contact;
  Wrench requested;  ///< Wrench on the hand before the limiter.
  /// Wrench on the hand as sent to the motors: after limiter and passivity controller.
  Wrench device;
  /// Wrench on the hand as held by the motors (device/motors.h): mean over the tick that ends here.
  Wrench motors;
  bool handle_valid = true;          ///< Whether the handle's pose is valid.
  bool limited = false;              ///< The requested wrench exceeded the device's maximum.
  bool ramps_in = false;             ///< The force ramps in again, after too long a gap without a wrench.
  std::uint32_t left_out = 0;        ///< Clock ticks omitted before this one (real time).
  std::uint32_t switches = 0;        ///< Bit i is 1 if switch i of the handle is pressed.
  std::uint64_t record_version = 0;  ///< Version of the contact record used by this tick; 0: none.
};

/// Observer of a run, called by the loop; recorders and measurements implement it.
class Observer {
 public:
  virtual ~Observer() = default;
  /// Called at the start and after every period.
  virtual void period(World&, double /*t*/) {}
  /// Called after each tick of the first hand.
  virtual void tick(const TickRecord&) {}
  /// Called after each tick of any hand, in the numbering of scene::hands_of(). Not overridden, it forwards
  /// the ticks of the first hand.
  virtual void tick_of(std::size_t hand, const TickRecord& tick_record) {
    if (hand == 0) tick(tick_record);
  }
  /// Called for each contact record made for the next ticks of the first hand.
  virtual void exchanged(const ContactRecord&) {}
  /// Called for each contact record of any hand. Not overridden, it forwards the records of the first hand.
  virtual void exchanged_of(std::size_t hand, const ContactRecord& record) {
    if (hand == 0) exchanged(record);
  }
  /// Called after every contact query, at its state; after `period` if both occur at the same time.
  virtual void queried(World&, double /*t*/) {}
  /// Returns whether energy() is to be called after every period. Without such an observer a run computes no
  /// balance.
  virtual bool wants_energy() const { return false; }
  /// Writes or restores the state needed to continue in another process or another World, after a period.
  /// Restoring replaces the call period(0).
  virtual void archive(Archive&) {}
  /// Called with the energy balance at the end of each period.
  virtual void energy(const EnergyBalance&) {}
};

/// Options of a run; defaults are the scene's values, or none.
struct RunOptions {
  double duration_s = 0.0;  ///< 0: the scene's
  /// Ticks by the wall clock in a separate thread; otherwise in virtual time.
  bool real_time = false;
  /// Whether the energy at the device's port is observed, or also controlled.
  device::PassivityController::Mode passivity = device::PassivityController::Mode::kOff;
  std::vector<Observer*> observers;               ///< Called in this order; they must outlive the run.
  std::function<void(double fraction)> progress;  ///< Called after every period.
  const std::atomic<bool>* stop = nullptr;        ///< Set from outside: the run ends after the current step.
  /// Called with a description of the event if the run has to wait for a device.
  std::function<void(const std::string& awaited)> waiting;
};

/// Energy at the device's port over a run (device/passivity.h) [J].
struct PortEnergy {
  double energy = 0.0, least = 0.0;  ///< Net energy put in by the hand: at the end, and its minimum.
  double work = 0.0, controller_dissipated = 0.0;  ///< Magnitude of the motors' work; part of the controller.
  long controller_ticks = 0;                       ///< Ticks in which the controller reduced the wrench.
};

/// Results of one further hand; the results of the first hand are members of RunResult.
struct HandResult {
  long ticks = 0;                  ///< Ticks of the tool.
  long limited_ticks = 0;          ///< Ticks in which the device's limit reduced the wrench.
  long outside_ticks = 0;          ///< Ticks with the handle outside the device's workspace.
  long rejected_ticks = 0;         ///< Ticks whose wrench or time was not finite: forces fall to zero.
  std::optional<PortEnergy> port;  ///< Only if passivity is observed or controlled.
  std::optional<double> buzz_n;    ///< Force on the hand above 30 Hz, RMS [N].
};

/// Result of a run: final status, cost and counters.
struct RunResult {
  dynamics::StepResult status;       ///< Not ok: the integrator failed; data recorded so far are valid.
  bool stopped = false;              ///< `RunOptions::stop` was set
  double time = 0.0;                 ///< Time reached [s].
  double cpu_s = 0.0, wall_s = 0.0;  ///< Cost of the loop, without assembly.
  double query_s = 0.0;              ///< Wall time in contact queries.
  double linearise_s = 0.0;          ///< Wall time in linearising contact for the tool.
  double tool_s = 0.0;               ///< Wall time in the tool's ticks.
  long periods = 0;                  ///< Periods of the loop.
  long ticks = 0;                    ///< Ticks of the first hand's tool.
  long contact_queries = 0;          ///< Each refreshes all pairs.
  long limited_ticks = 0;            ///< Ticks in which the device's limit reduced the wrench.
  long outside_ticks = 0;       ///< Ticks with the handle outside the device's workspace, where forces fade.
  long rejected_ticks = 0;      ///< Ticks whose wrench or time was not finite: forces fall to zero.
  std::vector<long> tunnelled;  ///< Vertices that tunnelled, one entry per [[contact]].
  std::optional<EnergyBalance> energy;  ///< At the end, if an observer requests it.
  long sub_steps = 0;                   ///< Additional contact queries for tunnelling = "substep"
  long shortest_refreshes = 0;          ///< Sub-steps that shortest_refresh_s made longer than required.
  long frozen_fallbacks = 0;  ///< Linearisations without a factor of the step matrix, frozen instead.
  dynamics::StepperCounters counters;       ///< Counters of the integrator.
  std::optional<RealTimeResult> real_time;  ///< Timing, for a run in real time.
  std::optional<PortEnergy> port;           ///< Only if passivity is observed or controlled.
  /// Force on the hand above 30 Hz, RMS [N]; only for sufficiently short ticks.
  std::optional<double> buzz_n;
  std::vector<HandResult> more_hands;  ///< One entry per [[hand]].
};

/// Visits all numbers of a run by name, including StepperCounters (dynamics/stepper.h).
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

/// Runs a scene in virtual time or in real time. In virtual time one exchange period follows the other, with
/// interleaved ticks (docs/design.md, 1); if monolithic, one contact refresh follows the other, and ticks are
/// read from dense output. A scene without a tool has periods but no ticks. In real time the ticks follow the
/// wall clock in a separate thread, and the bodies follow one period later. The number of threads is the
/// World's (integrator.threads), whatever other Worlds use.
/// @throws Error as check_clock(), and in real time if an awaited device does not appear
RunResult run(World& world, const RunOptions& options);

/// Rejects scenes that cannot run with that clock, before anything is written.
/// @throws Error in real time for a scene without a tool with ticks, or with hands of different tick_s; in
/// virtual time for a device that is moved in wall-clock time
void check_clock(const World& world, bool real_time);

/// Returns the length of the loop's period for a scene [s]: the exchange period if the scene has one, else
/// the contact refresh period, else the recording period.
double period_of(const scene::Description& description);

}  // namespace palpate::loop
