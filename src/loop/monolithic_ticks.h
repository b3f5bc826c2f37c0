#pragma once
#include <functional>

#include "palpate/loop/observer.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

/// Returns the record of a tick of a tool in the State: its motion, contact, and the hand in the State.
TickRecord tick_at(const World& world, const ToolInstance& tool, double t, const dynamics::StateView& state);

/// Haptic ticks of a monolithic scene. The integrator chooses its steps, and the tools at the ticks (with the
/// first tool's tick length) are read from its dense output. An integrator without step reports stops at
/// every tick instead.
class MonolithicTicks : private dynamics::StepFollower {
 public:
  /// Receives time, tool and contact wrench of each hand.
  using Emit = std::function<void(std::size_t hand, const TickRecord& tick)>;
  MonolithicTicks(World& world, Emit emit);
  ~MonolithicTicks() override;
  /// Advances the World's stepper to t1 and emits all ticks up to t1.
  dynamics::StepResult advance_to(double t1);
  void archive(Archive& a) { a("count", count_); }

 private:
  void stepped(const dynamics::Stepper& stepper, double t0, double t1) override;
  double next() const { return static_cast<double>(count_ + 1) * tick_s_; }
  bool due(double t) const;
  void emit_at(double t, const dynamics::StateView& state);

  World& world_;
  Emit emit_;
  double tick_s_;
  long count_ = 0;  ///< Ticks so far.
  bool follows_;
  VecX q_, u_;
};

}  // namespace palpate::loop
