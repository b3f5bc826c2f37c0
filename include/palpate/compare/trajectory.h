#pragma once
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::compare {

/// Data that runs are compared by: node positions after every period, and the device wrench at every tick.
struct Trajectory {
  std::vector<double> period_times;  ///< [s]
  /// all node blocks (without a body: the tool's origin), one vector a period [m]
  std::vector<VecX> positions;
  std::vector<double> energies;    ///< of the bodies [J]
  std::vector<double> tick_times;  ///< [s]
  std::vector<Wrench> device;      ///< on the hand
  VecX node_weights;               ///< mass of the node of each entry [kg]
  VecX start;                      ///< positions at the start [m]
};

/// Collects a Trajectory while a run goes on.
class TrajectoryRecorder : public loop::Observer {
 public:
  void period(loop::World& world, double t) override;
  void tick(const loop::TickRecord& tick) override;
  const Trajectory& trajectory() const { return trajectory_; }

 private:
  Trajectory trajectory_;
  Vec3 tool_origin_ = Vec3::Zero();
};

/// Collects of a Trajectory what the hand felt alone: ticks and device wrenches.
class WrenchRecorder : public loop::Observer {
 public:
  void tick(const loop::TickRecord& tick) override;
  const Trajectory& trajectory() const { return trajectory_; }

 private:
  Trajectory trajectory_;
};

/// Distance of a trajectory from a reference at their common times.
struct TrajectoryError {
  /// mass-weighted L2 over nodes and times, relative to that of the reference's displacement
  double position_rel_l2 = 0.0;
  double position_max_m = 0.0;
  double force_rms_n = 0.0, force_max_n = 0.0;
  double torque_rms_n_m = 0.0, torque_max_n_m = 0.0;
  double energy_j = 0.0;  ///< largest difference of mechanical energy
};
TrajectoryError distance(const Trajectory& computed, const Trajectory& reference);
/// Of the wrench on the hand alone, at the ticks that both have; all else is NaN.
/// @throws Error where they have no tick in common
TrajectoryError wrench_distance(const Trajectory& computed, const Trajectory& reference);
/// The error of a run that did not reach its end, where the common times would show only its good part: NaN
/// throughout.
TrajectoryError no_distance();

/// Assembles and runs one description; times the loop without assembly.
struct Run {
  Trajectory trajectory;
  loop::RunResult result;
};
Run run_once(const scene::Description& description, double duration_s,
             const std::atomic<bool>* stop = nullptr);
/// Likewise, with ticks and wrenches alone in the trajectory.
Run run_for_wrenches(const scene::Description& description, double duration_s,
                     const std::atomic<bool>* stop = nullptr);

}  // namespace palpate::compare
