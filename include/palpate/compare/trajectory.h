#pragma once
#include <functional>
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
  /// One node block in the positions.
  struct Body {
    Eigen::Index first, size;  ///< its entries of `positions`
  };
  std::vector<Body> bodies;  ///< in the State's order
};

/// Collects a Trajectory while a run goes on.
class TrajectoryRecorder : public loop::Observer {
 public:
  void period(loop::World& world, double t) override;
  void tick(const loop::TickRecord& tick) override;
  /// So far.
  const Trajectory& trajectory() const { return trajectory_; }
  double cpu_s() const { return cpu_s_; }  ///< spent in recording, the bodies' energy included

 private:
  Trajectory trajectory_;
  Vec3 tool_origin_ = Vec3::Zero();
  double cpu_s_ = 0.0;
};

/// Collects of a Trajectory what the hand felt alone: ticks and device wrenches.
class WrenchRecorder : public loop::Observer {
 public:
  void tick(const loop::TickRecord& tick) override;
  /// So far.
  const Trajectory& trajectory() const { return trajectory_; }
  /// Spent in recording.
  double cpu_s() const { return cpu_s_; }

 private:
  Trajectory trajectory_;
  double cpu_s_ = 0.0;
};

/// Distance of a trajectory from a reference at their common times.
struct TrajectoryError {
  /// mass-weighted L2 over nodes and times, relative to that of the reference's deformation: of its
  /// displacement what the nearest rigid motion of each body leaves (rigid_fit.h).  A scene in which nothing
  /// deforms is held against its displacement.
  double position_rel_l2 = 0.0;
  double position_max_m = 0.0;                        ///< largest distance of a node, at any common time
  double force_rms_n = 0.0, force_max_n = 0.0;        ///< of the force on the hand, over the common ticks
  double torque_rms_n_m = 0.0, torque_max_n_m = 0.0;  ///< likewise, of the torque
  double energy_j = 0.0;                              ///< largest difference of mechanical energy
};
/// The reference leaves a tenth in doubt of an error this many times its own; points closer to it are marked,
/// and enter no fit and no verdict.
constexpr double kResolution = 10.0;
/// All of it.  @throws InternalError where the two have no time in common, or not the same nodes
TrajectoryError distance(const Trajectory& computed, const Trajectory& reference);
/// Of the wrench on the hand alone, at the ticks that both have; all else is NaN.
/// @throws Error where they have no tick in common
TrajectoryError wrench_distance(const Trajectory& computed, const Trajectory& reference);
/// The error of a run that did not reach its end, where the common times would show only its good part: NaN
/// throughout.
TrajectoryError no_distance();

/// Assembles and runs one description.
struct Run {
  Trajectory trajectory;                 ///< what happened
  loop::RunResult result;                ///< its CPU time that of the loop, without assembly and recording
  double setup_s = 0.0, record_s = 0.0;  ///< CPU time of these
};
/// @param description  the scene  @param duration_s  of the run  @param stop  set from outside, ends it
/// @param spoil  changes the World once it is assembled: a defect that a study must find
Run run_once(const scene::Description& description, double duration_s,
             const std::atomic<bool>* stop = nullptr, const std::function<void(loop::World&)>& spoil = {});
/// Likewise, with ticks and wrenches alone in the trajectory.
Run run_for_wrenches(const scene::Description& description, double duration_s,
                     const std::atomic<bool>* stop = nullptr);

}  // namespace palpate::compare
