#pragma once
#include <string>
#include <vector>

#include "palpate/experiments/comparison.h"

namespace palpate::compare {

/// Run of the scene with one parameter changed.
struct HapticPoint {
  /// Parameter that differs: "exchange period", "exchange alone" (exchange period with a tick of a tenth of
  /// it, all else as in the reference), "tick", "pixels", "element size", "integrator",
  /// "scheme", "linearisation".
  std::string variable;
  std::string value;     ///< Its value as text: "10 ms", "cvode-bdf".
  double setting = 0.0;  ///< Its value, where it is a number; else NaN.
  bool own = false;      ///< The value is the scene's: nothing differs.
  scene::Description description;
  Status status = Status::kMissing;
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

/// Acceptance limit of points for fitted orders, relative to the reference's peak: larger errors are beyond
/// the asymptotic range.
inline constexpr double kOrderPeakShare = 0.1;

}  // namespace palpate::compare
