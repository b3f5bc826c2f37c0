#pragma once
#include <map>
#include <string>
#include <vector>

#include "loop/haptic_record.h"
#include "palpate/compare/compare.h"

namespace palpate::compare {

/// Run of the scene with one parameter changed.
struct HapticPoint {
  /// Parameter that differs: "exchange period", "exchange alone" (exchange period with a tick of a tenth of
  /// it, all else as in the reference), "tick", "pixels", "element size", "integrator", "linearisation".
  std::string variable;
  std::string value;     ///< Its value as text: "10 ms", "cvode-bdf".
  double setting = 0.0;  ///< Its value, where it is a number; else NaN.
  bool own = false;      ///< The value is the scene's: nothing differs.
  scene::Description description;
  PointStatus status = PointStatus::kMissing;
  std::string reason;  ///< Reason, where the status is not kOk.
  /// Error of the wrench on the hand; NaN where the status is not kOk, or without a reference.
  TrajectoryError error = no_distance();
  bool force_unresolved = false, torque_unresolved = false;  ///< See kResolution.
  loop::RunResult result;                                    ///< Result of the first repeat.
  std::vector<double> cpu_s;                                 ///< CPU time of each repeat [s].
  double cpu_median_s = 0.0;
  /// Returns the wall time of everything except queries, linearisations and ticks [s].
  double bodies_s() const { return result.wall_s - result.query_s - result.linearise_s - result.tool_s; }
};

/// Slope of log error over log setting, for one variable.
struct HapticOrder {
  std::string variable;
  double force = 0.0, torque = 0.0;  ///< NaN with fewer than two points.
  int force_points = 0, torque_points = 0;
};

/// Error of the force on the hand against the monolithic solution.
struct HapticComparison {
  std::string scene, path;
  Reference reference;                               ///< Only force and torque of its `own_error` are set.
  double peak_force_n = 0.0, peak_torque_n_m = 0.0;  ///< Peaks of the reference.
  std::vector<HapticPoint> points;                   ///< By variable; from coarse to fine.
  std::vector<HapticOrder> orders;                   ///< For exchange period, exchange alone and tick.
  std::string rules;  ///< Text that describes how runs were repeated and limited.
  long reused = 0;    ///< Number of runs taken from an earlier study.
  bool stopped = false;
};

/// A peak below this is rounding [N], [N m]: a scene without torque has no relative torque error, and no
/// order.
inline constexpr double kLeastPeak = 1e-12;

/// Returns the error relative to the peak; NaN where the peak is at most kLeastPeak.
double share_of_peak(double error, double peak);

/// Acceptance limit of points for fitted orders, relative to the reference's peak: larger errors are beyond
/// the asymptotic range.
inline constexpr double kOrderPeakShare = 0.1;

/// Varies exchange period, tick, contact resolution, integrator and linearisation about the scene, one at a
/// time, and measures the error of the wrench on the hand against the monolithic solution
/// (`[compare.haptic]`). Each run has a separate process: references run in parallel, the timed points one at
/// a time unless `options.jobs` specifies otherwise.
/// @param options  integrators: replaces the scene's list; all: not used
/// @throws Error for a scene without a tool or without bodies
HapticComparison compare_haptic(const scene::Description& description, const CompareOptions& options);

/// Writes haptic.csv into `folder`: report takes its table and charts from it and from summary.json.
void write(const HapticComparison& comparison, const std::string& folder);

/// Scene with tool and bodies as one system, with the integrator and contact refresh of `[compare.haptic]`.
struct MonolithicScene {
  scene::Description description;
  std::string made_by;  ///< Description for reports.
};
/// Makes the monolithic scene.
/// @param coarser  factor on step and refresh period of the keys; the tolerance is multiplied by
///   coarser^log2(10), ten for 2.  Above 1, the integrator is the check's.
MonolithicScene monolithic_scene(const scene::Description& description, double coarser = 1.0);

/// Error of the wrench on one hand.
struct HandError {
  TrajectoryError error = no_distance();
  double peak_force_n = 0.0, peak_torque_n_m = 0.0;  ///< Peaks of the reference.
};

/// Result of comparing a completed run with its monolithic solution under the same hand motion; the inherited
/// members refer to the first hand.
struct AgainstMonolithic : HandError {
  std::string made_by;  ///< Description of the reference.
  /// The reference was driven by the recorded hands instead of the scene's prescribed paths.
  bool recorded_hand = false;
  double cpu_s = 0.0;                 ///< CPU time of the reference [s].
  std::vector<HandError> more_hands;  ///< Errors of each [[hand]].
  bool stopped = false;
  std::string trouble{};  ///< Reason why there is no error.
};
/// Repeats a run with monolithic_scene().  For a run in real time, and for a hand without a prescribed path,
/// the recorded hands drive the reference.
/// @param world  World of the run
/// @param records  records of each hand
/// @param real_time  whether the run was in real time
/// @throws Error as refuse_against_monolithic()
AgainstMonolithic against_monolithic(const loop::World& world, const std::vector<loop::HapticRecord>& records,
                                     bool real_time, const std::function<void(double)>& progress,
                                     const std::atomic<bool>* stop);
/// Checks that a scene has a monolithic counterpart.  @throws Error for a scene without a tool or without
/// bodies, and for one that is monolithic itself
void refuse_against_monolithic(const scene::Description& description);

}  // namespace palpate::compare
