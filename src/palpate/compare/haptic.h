#pragma once
#include <map>
#include <string>
#include <vector>

#include "palpate/compare/compare.h"
#include "palpate/loop/haptic_record.h"

namespace palpate::compare {

/// One run of the scene, in which one thing differs from it.
struct HapticPoint {
  /// "exchange period", "exchange alone" (period, tick a tenth of it, all else as in the reference), "tick",
  /// "pixels", "element size", "integrator", "linearisation"
  std::string variable;
  std::string value;     ///< of it, for people: "10 ms", "cvode-bdf"
  double setting = 0.0;  ///< of it, where it is a number; else NaN
  bool own = false;      ///< it is the scene's own: nothing differs
  scene::Description description;
  PointStatus status = PointStatus::kMissing;
  std::string reason;  ///< where the status is not kOk
  /// of the wrench on the hand; NaN where the status is not kOk, or where there is no reference
  TrajectoryError error = no_distance();
  bool force_unresolved = false, torque_unresolved = false;  ///< see kResolution
  loop::RunResult result;                                    ///< of the first repeat
  std::vector<double> cpu_s;                                 ///< of each repeat
  double cpu_median_s = 0.0;
  /// wall time of all but queries, linearisations and ticks
  double bodies_s() const { return result.wall_s - result.query_s - result.linearise_s - result.tool_s; }
};

/// Slope of log error over log setting of one variable.
struct HapticOrder {
  std::string variable;
  double force = 0.0, torque = 0.0;  ///< NaN with fewer than two points
  int force_points = 0, torque_points = 0;
};

/// How far the force on the hand is from that of tool and bodies as one system.
struct HapticComparison {
  std::string scene, path;
  Reference reference;                               ///< of its own errors those of force and torque
  double peak_force_n = 0.0, peak_torque_n_m = 0.0;  ///< of the reference
  std::vector<HapticPoint> points;                   ///< by variable; coarse to fine
  std::vector<HapticOrder> orders;                   ///< of exchange period, exchange alone and tick
  std::string rules;                                 ///< how runs were repeated and limited, in words
  long reused = 0;                                   ///< runs that an earlier study had done
  bool stopped = false;
};

/// A peak below this is rounding [N], [N m]: a scene without torque has no error of it in percent,
/// and no order.
inline constexpr double kLeastPeak = 1e-12;

/// Share of a peak; NaN where there is none.
double share_of_peak(double error, double peak);

/// Points whose error is above this share of the reference's peak enter no fitted order: of a force that is
/// wrong throughout, no power of the period is left.
inline constexpr double kOrderPeakShare = 0.1;

/// Varies exchange period, tick, contact resolution, integrator and linearisation about the scene, one at a
/// time, and measures the wrench on the hand against the scene with tool and bodies as one system
/// (`[compare.haptic]`).  Each run has a process of its own: references side by side, the points, whose time
/// is measured, one at a time unless `options.jobs` says otherwise.
/// @param options  integrators: only these in place of the scene's list; all: no meaning
/// @throws Error for a scene without a tool or without bodies
HapticComparison compare_haptic(const scene::Description& description, const CompareOptions& options);

/// Writes haptic.csv into `folder`: report reads its table and charts from it and from summary.json.
void write(const HapticComparison& comparison, const std::string& folder);

/// The scene with tool and bodies as one system, by the integrator and contact refresh of `[compare.haptic]`.
struct MonolithicScene {
  scene::Description description;
  std::string made_by;  ///< in words
};
/// @param coarser  how many times the step (the refresh; ten times as often the tolerance) is that of the key
MonolithicScene monolithic_scene(const scene::Description& description, double coarser = 1.0);

/// Of what one hand felt.
struct FeltError {
  TrajectoryError error = no_distance();
  double peak_force_n = 0.0, peak_torque_n_m = 0.0;  ///< of the reference
};

/// A run that was made, against its scene as one system under the same hands; of the first hand its own
/// figures.
struct AgainstMonolithic : FeltError {
  std::string made_by;         ///< the reference, in words
  bool recorded_hand = false;  ///< held by the hands as they were recorded, not by the scene's own paths
  double cpu_s = 0.0;          ///< of the reference
  std::vector<FeltError> more_hands;  ///< of each [[hand]]
  bool stopped = false;
  std::string trouble{};  ///< why there is no error
};
/// Repeats a run as monolithic_scene().  One in real time, and one of a hand whose path nobody knows
/// beforehand, is held by the hands as they were recorded.
/// @param world  of the run  @param records  of each hand  @param real_time  whether the run was
/// @throws Error for what refuse_against_monolithic() refuses
AgainstMonolithic against_monolithic(const loop::World& world, const std::vector<loop::HapticRecord>& records,
                                     bool real_time, const std::function<void(double)>& progress,
                                     const std::atomic<bool>* stop);
/// @throws Error for a scene without a tool or without bodies, and for one that is monolithic itself
void refuse_against_monolithic(const scene::Description& description);

}  // namespace palpate::compare
