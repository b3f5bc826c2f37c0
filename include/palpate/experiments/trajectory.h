#pragma once
#include <functional>
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::compare {

/// Data by which runs are compared: node positions after every period, and the device wrench at every tick.
struct Trajectory {
  std::vector<double> period_times;  ///< Ends of periods [s].
  /// All node blocks (without a body: the tool's origin), one vector per period [m].
  std::vector<VecX> positions;
  std::vector<double> energies;    ///< Mechanical energy of the bodies [J].
  std::vector<double> tick_times;  ///< Ends of ticks [s].
  std::vector<Wrench> device;      ///< Wrench on the hand at each tick.
  VecX node_weights;               ///< Nodal mass of each entry [kg].
  VecX start;                      ///< Initial positions [m].
  /// Node block of one body in the positions.
  struct Body {
    Eigen::Index first, size;  ///< Range of entries in `positions`.
  };
  std::vector<Body> bodies;  ///< In the State's order.

  void archive(Archive& a);  ///< Writes the values to an archive, or restores them.
};

/// Records a Trajectory during a run.
class TrajectoryRecorder : public loop::Observer {
 public:
  void period(loop::World& world, double t) override;
  void tick(const loop::TickRecord& tick) override;
  /// Returns the trajectory so far.
  const Trajectory& trajectory() const { return trajectory_; }
  double cpu_s() const { return cpu_s_; }  ///< CPU time of recording, including the bodies' energy [s].

 private:
  Trajectory trajectory_;
  Vec3 tool_origin_ = Vec3::Zero();
  double cpu_s_ = 0.0;
};

/// Records only ticks and device wrenches of a Trajectory.
class WrenchRecorder : public loop::Observer {
 public:
  void tick(const loop::TickRecord& tick) override;
  /// Returns the trajectory so far.
  const Trajectory& trajectory() const { return trajectory_; }
  /// Returns the CPU time of recording [s].
  double cpu_s() const { return cpu_s_; }

 private:
  Trajectory trajectory_;
  double cpu_s_ = 0.0;
};

/// Distance of a trajectory from a reference at their common times.
struct TrajectoryError {
  /// Mass-weighted L2 norm over nodes and times, relative to the norm of the reference's deformation: its
  /// displacement minus the best-fit rigid motion of each body (rigid_fit.h).  Relative to the displacement
  /// where nothing deforms.
  double position_rel_l2 = 0.0;
  double position_max_m = 0.0;                        ///< Largest distance of a node, at any common time.
  double force_rms_n = 0.0, force_max_n = 0.0;        ///< Force on the hand, over the common ticks.
  double torque_rms_n_m = 0.0, torque_max_n_m = 0.0;  ///< Torque on the hand, over the common ticks.
  double energy_j = 0.0;                              ///< Largest difference of mechanical energy.

  void archive(Archive& a);  ///< Writes the values to an archive, or restores them.
};
/// Resolution factor: errors must be at least this many times the reference error, which leaves an
/// uncertainty of a tenth.  Smaller ones are marked, and are excluded from fits and verdicts.
constexpr double kResolution = 10.0;
/// Returns all errors.  @throws InternalError where the two have no time in common, or different nodes
TrajectoryError distance(const Trajectory& computed, const Trajectory& reference);
/// Returns the errors of the wrench on the hand, at the common ticks; all others are NaN.
/// @throws Error where they have no tick in common
TrajectoryError wrench_distance(const Trajectory& computed, const Trajectory& reference);
/// Returns NaN throughout: the error of a run that did not reach its end, where the common times would show
/// only its valid part.
TrajectoryError no_distance();

/// Result of one run.
struct Run {
  Trajectory trajectory;   ///< Recorded trajectory.
  loop::RunResult result;  ///< Its CPU time is that of the loop, without assembly and recording.
  double setup_s = 0.0, record_s = 0.0;  ///< CPU time of assembly and of recording [s].

  void archive(Archive& a);  ///< Writes the values to an archive, or restores them.
};
/// Assembles and runs one description.
/// @param description  scene
/// @param duration_s  simulated time [s]
/// @param stop  set from outside; ends the run
/// @param seed_defect  modifies the World after assembly: seeds a defect that a study must detect
Run run_once(const scene::Description& description, double duration_s,
             const std::atomic<bool>* stop = nullptr,
             const std::function<void(loop::World&)>& seed_defect = {});
/// As run_once(), with ticks and wrenches only in the trajectory.
Run run_for_wrenches(const scene::Description& description, double duration_s,
                     const std::atomic<bool>* stop = nullptr);

}  // namespace palpate::compare
