#pragma once
#include <concepts>
#include <optional>
#include <type_traits>
#include <vector>

#include "palpate/dynamics/stepper.h"
#include "palpate/loop/energy_balance.h"
#include "palpate/loop/real_time.h"

namespace palpate::loop {

/// Energy at the device's port over a run (device/passivity.h) [J].
struct PortEnergy {
  double energy = 0.0, least = 0.0;    ///< Net energy put in by the hand: at the end, and its minimum.
  double work = 0.0;                   ///< Magnitude of the motors' work.
  double controller_dissipated = 0.0;  ///< Energy that reductions kept from the hand, either sign.
  long controller_ticks = 0;           ///< Ticks in which the controller reduced the wrench.
};

/// Results of one further hand; the results of the first hand are members of RunResult.
struct HandResult {
  long ticks = 0;                  ///< Ticks of the tool.
  long limited_ticks = 0;          ///< Ticks in which the device's limit reduced the wrench.
  long outside_ticks = 0;          ///< Ticks with the handle outside the device's workspace.
  long rejected_ticks = 0;         ///< Ticks whose wrench or time was not finite: forces fall to zero.
  std::optional<PortEnergy> port;  ///< Only if passivity is observed or controlled.
  std::optional<double> buzz_n;    ///< Force on the hand above 30 Hz, RMS [N].
  long ticks_without_pose = 0;     ///< Ticks whose last pose of the device is too old for a force.
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
  long ticks_without_pose = 0;  ///< Ticks whose last pose of the device is too old for a force.
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

}  // namespace palpate::loop
