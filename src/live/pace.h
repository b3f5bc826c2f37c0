#pragma once
#include "live/controls.h"
#include "palpate/loop/observer.h"

namespace palpate::live {

/// Observer that holds a run in virtual time back to the wall clock, for scenes without a hand. Such a scene
/// is watched only, so no tick has a due time. A scene that is slower than real time runs at its own speed.
class Pace : public loop::Observer {
 public:
  /// @param controls  whether the run is paused or to be ended  @param then  receives the timing of each
  /// period
  Pace(Controls& controls, loop::Observer& then) : controls_(controls), then_(then) {}
  void period(loop::World& world, double t) override;

 private:
  void wait_until(double due_s);
  Controls& controls_;
  loop::Observer& then_;
  double start_s_ = 0.0, woke_s_ = 0.0;
};

}  // namespace palpate::live
