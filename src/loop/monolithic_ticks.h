#pragma once
#include <functional>

#include "palpate/loop/run.h"

namespace palpate::loop {

/// The haptic ticks of a monolithic scene: the integrator steps tool and bodies as it likes, and the tool at
/// each tick, of the first tool's period, is read from its dense output.  An integrator that does not report
/// its steps is made to land on every tick instead.
class MonolithicTicks : private dynamics::StepFollower {
 public:
  /// gets time, tool and the contact's wrench of each hand
  using Emit = std::function<void(std::size_t hand, const TickRecord& tick)>;
  MonolithicTicks(World& world, Emit emit);
  ~MonolithicTicks() override;
  /// Advances the World's stepper to t1 and emits the ticks on the way, the last one at t1 or before.
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
  long count_ = 0;  ///< ticks so far
  bool follows_;
  VecX q_, u_;
};

}  // namespace palpate::loop
