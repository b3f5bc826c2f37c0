#pragma once
#include <memory>
#include <vector>

#include "live/live_scene.h"
#include "live/timing_window.h"
#include "palpate/device/passivity.h"
#include "palpate/loop/observer.h"

namespace palpate::live {

/// Observer of a run that hands its state to the server's thread: frames, rows of the force strip and
/// figures. In a period and a tick it neither waits nor allocates; the exceptions are changes of a Young's
/// modulus by a viewer, and the energy (partitioned scheme only, in the thread of the bodies, at most 2 % of
/// its time).
class WorldObserver : public loop::Observer {
 public:
  /// Shortest simulated time between two frames [s].
  static constexpr double kFramePeriod = 0.008;

  /// Sets the scene to write to, before the run.
  void attach(std::shared_ptr<LiveScene> scene, const loop::World& world);
  void period(loop::World& world, double t) override;
  void tick_of(std::size_t hand, const loop::TickRecord& tick) override;
  void timed(const loop::TickTiming& timing) override;

 private:
  struct HandState {
    loop::TickRecord tick;
    bool ticked = false;
  };
  void change_moduli(loop::World& world);
  void write_frame(loop::World& world, double t);
  void write_status(loop::World& world, double t);
  void update_energy(loop::World& world);

  std::shared_ptr<LiveScene> scene_;
  std::vector<HandState> hands_;
  std::vector<device::PassivityObserver> ports_;        ///< One per hand.
  double port_energy_ = 0.0, least_port_energy_ = 0.0;  ///< Sum over the hands [J], and its minimum.
  TimingWindow timing_{1e-3};
  bool may_compute_energy_ = false;
  double last_frame_ = -1.0, last_status_ = -1.0, next_energy_ = 0.0;
  LiveStatus status_;
};

}  // namespace palpate::live
