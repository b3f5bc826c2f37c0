#pragma once
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "palpate/experiments/exchange_period_study.h"
#include "palpate/experiments/status.h"
#include "palpate/experiments/trajectory.h"

namespace palpate::compare {

using experiments::Status;

/// Point of the work-precision diagram: one integrator at one tolerance or step.
struct ComparePoint {
  std::string label;  ///< Name of its refinement sequence in reports; unique in a scene.
  std::string integrator, family, stability;  ///< Properties of the method, from the registry.
  int order = 0;                              ///< Theoretical order.
  bool multistep = false;    ///< A multistep method, which restarts its history at each exchange.
  std::string setting_name;  ///< "rtol", "step_s" or "tick_s".
  double setting = 0.0;      ///< Value of the setting.
  /// Relative tolerance of the method's error test; NaN where it has none.
  double error_test_rtol = std::numeric_limits<double>::quiet_NaN();
  bool coarsest = false;  ///< No coarser setting is meaningful.
  /// Level of a default sequence, which ends where the reference no longer resolves errors.
  bool open_ended = false;
  std::string linear_solver;  ///< Empty: the method solves no linear systems.
  /// Integrator of the reference used; its family differs from the point's where possible.
  std::string against;
  scene::Description description;    ///< Scene with all settings of this point.
  Status status = Status::kMissing;  ///< Outcome.
  std::string reason;                ///< Reason, where the status is not kOk.
  /// Error against the reference; NaN throughout where the status is not kOk, or without a reference.
  TrajectoryError error;
  loop::RunResult result;     ///< Result of the first repeat; counts are equal in all repeats.
  std::vector<double> cpu_s;  ///< CPU time of each repeat [s]: the loop without assembly and recording.
  double cpu_median_s = 0.0, cpu_min_s = 0.0, cpu_max_s = 0.0;  ///< Over all repeats [s].
  /// First repeat [s]: assembly; recording, including the bodies' energy.
  double setup_s = 0.0, record_s = 0.0;
  /// Returns the CPU time of the first repeat's loop minus the wall times of contact queries, linearisations
  /// and ticks [s].
  double method_s() const { return result.cpu_s - result.query_s - result.linearise_s - result.tool_s; }
  /// Whether the position error is less than kResolution times the reference error: not to be trusted.
  bool unresolved = false;
  bool force_unresolved = false;   ///< As `unresolved`, for the RMS error of the force on the hand.
  bool torque_unresolved = false;  ///< As `unresolved`, for the RMS error of the torque.
};

/// Reference solution that the points are compared with, and its accuracy.
struct Reference {
  std::string description;  ///< Integrators of the reference and of its check.
  std::string trouble;      ///< Which of the two is missing, and why; empty: none.
  bool available = false;   ///< Without a reference no point has an error.
  /// Reference error: distance of two method families at tight tolerance; NaN without a check.
  TrajectoryError own_error = no_distance();
  /// Peaks on the hand; a torque that is only rounding is zero.
  double peak_force_n = 0.0, peak_torque_n_m = 0.0;
  double cpu_s = 0.0;  ///< CPU time of the run that serves as reference [s].
};

/// Result of one contact method for the tool, compared with the first method of the scene's list: shows the
/// effect of the choice of method.
struct MethodPoint {
  std::string method;                 ///< Value of `contact.method`.
  TrajectoryError difference;         ///< Zero for the first method.
  double peak_force_n = 0.0;          ///< Peak of the force on the hand.
  long most_samples = 0;              ///< Largest number of contact samples at one time.
  double query_s = 0.0, cpu_s = 0.0;  ///< Wall time of contact queries; CPU time of the loop [s].
  std::string trouble{};              ///< Reason why the scene could not be run with it; empty: it could.

  void archive(Archive& a);  ///< Writes the values to an archive, or restores them.
};

/// Chart, or part of one, that could not be made.
struct MissingChart {
  std::string of;   ///< Subject: "the contact methods", "the contact method \"gpu\"".
  std::string why;  ///< Reason, with the remedy.
  /// Returns one sentence.
  std::string text() const { return "no chart of " + of + ": " + why; }
};

/// Comparison of one scene.
struct SceneComparison {
  std::string scene, path;           ///< Name, and file.
  bool tool = false;                 ///< Whether the scene contains a [tool].
  Reference reference;               ///< Reference of all errors.
  std::vector<ComparePoint> points;  ///< Every level of every refinement sequence.
  /// Setting "contact_refresh_s": cost of re-initialisation; empty where the scene requests none.
  std::vector<ComparePoint> restarts;
  /// Error of the exchange period alone; empty where the scene requests none.
  ExchangeStudy exchange;
  std::vector<MethodPoint> methods;          ///< Methods that could be run; empty where the scene lists none.
  std::vector<MissingChart> missing_charts;  ///< With their reasons.
  /// Trials of LinearSolvers::kBest: the middle level of each sequence with each solver; labels are the
  /// sequences' labels, followed by the solver.
  std::vector<ComparePoint> trials;
};

/// Result of `palpate compare`.
struct Comparison {
  std::vector<SceneComparison> scenes;  ///< In the order given.
  std::string rules;                    ///< Text that describes how runs were repeated and limited.
  long reused = 0;                      ///< Number of runs taken from an earlier, unfinished comparison.
  bool stopped = false;                 ///< Stopped from outside: the remaining points are missing.
};

/// Choice of the linear solver of implicit methods.
enum class LinearSolvers {
  kSame,   ///< One solver for all (`linear_solver`), so that only methods are compared.
  kBest,   ///< Fastest solver of each method, measured at the middle level of its sequence.
  kNamed,  ///< Solver of the scene, or else the method's default.
};

/// Options of `palpate compare`.
struct CompareOptions {
  LinearSolvers linear_solvers = LinearSolvers::kSame;  ///< Choice of linear solvers.
  std::string linear_solver = "cholmod";                ///< Solver for kSame: a direct one adds no error.
  /// Maximum number of repeats; a point is repeated only while its runs together took less than a fifth of
  /// the limit.
  int repeats = 3;
  double limit_s = 10.0;             ///< CPU seconds per point.
  double reference_limit_s = 120.0;  ///< CPU seconds each for a reference, its check, and each further chart.
  /// Number of parallel runs; 0: references on all cores, and timed runs one at a time.
  int jobs = 0;
  /// Names or labels; empty: the scene's sequences and all other integrators that are not static.
  std::vector<std::string> integrators;
  bool all = false;    ///< Also every integrator that is not static.
  std::string folder;  ///< Folder whose results.db keeps results, and resumes a comparison; empty: none.
  /// Called after each run.
  std::function<void(double fraction, const std::string& what)> progress;
  const std::atomic<bool>* stop = nullptr;  ///< Set from outside: active runs are ended.
};

}  // namespace palpate::compare
