#pragma once
#include <cstdint>

#include "palpate/core/archive.h"
#include "palpate/core/pose.h"
#include "palpate/loop/energy_balance.h"

namespace palpate::loop {

struct ContactRecord;
struct World;

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

/// Timing of one tick of a run in real time, equal for all hands.
struct TickTiming {
  float lateness_s = 0.0F;     ///< From the due time of the tick to the wake-up of its thread [s].
  float work_s = 0.0F;         ///< From the wake-up to the wrench on the last device [s].
  std::uint32_t skipped = 0;   ///< Ticks that this one covers in addition (single-rate scheme).
  std::uint32_t left_out = 0;  ///< Clock ticks omitted before this one.
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
  /// Called after the ticks of all hands with the same time, in real time only.
  virtual void timed(const TickTiming&) {}
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

}  // namespace palpate::loop
