#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "palpate/device/passivity.h"
#include "palpate/scene/description.h"

namespace palpate::loop {

class Observer;
struct World;

/// Options of a run; defaults are the scene's values, or none.
struct RunOptions {
  /// Simulated time [s]; 0: the scene's; infinity: until `stop` is set.
  double duration_s = 0.0;
  /// Ticks by the wall clock in a separate thread; otherwise in virtual time.
  bool real_time = false;
  /// Whether the energy at the device's port is observed, or also controlled.
  device::PassivityController::Mode passivity = device::PassivityController::Mode::kOff;
  std::vector<Observer*> observers;               ///< Called in this order; they must outlive the run.
  std::function<void(double fraction)> progress;  ///< Called after every period.
  const std::atomic<bool>* stop = nullptr;        ///< Set from outside: the run ends after the current step.
  /// While it is set from outside, a run in real time holds: devices get no force, and simulated time does
  /// not advance.
  const std::atomic<bool>* pause = nullptr;
  /// Called with a description of the event if the run has to wait for a device.
  std::function<void(const std::string& awaited)> waiting;
};

/// Rejects scenes that cannot run with that clock, before anything is written.
/// @throws Error in real time for a scene without a tool with ticks, or with hands of different tick_s; in
/// virtual time for a device that is moved in wall-clock time
void check_clock(const World& world, bool real_time);

/// Returns the length of the loop's period for a scene [s]: the exchange period if the scene has one, else
/// the contact refresh period, else the recording period.
double period_of(const scene::Description& description);

}  // namespace palpate::loop
