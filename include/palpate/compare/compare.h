#pragma once
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "palpate/compare/exchange.h"
#include "palpate/compare/trajectory.h"

namespace palpate::compare {

/// Outcome of a point.
enum class PointStatus {
  kOk,
  kFailed,  ///< the integrator gave up
  kOutOfTime,
  kCrashed,   ///< its process ended by a signal
  kRefused,   ///< the integrator cannot run this scene with these settings
  kNotTried,  ///< a coarser rung ran out of time
  kMissing,   ///< the study was stopped before it
};
/// For tables: "ok", "failed".
const char* to_string(PointStatus status);

/// One point of the work-precision chart: one integrator at one tolerance or step.
struct ComparePoint {
  std::string label;                          ///< what reports call its ladder; unique in a scene
  std::string integrator, family, stability;  ///< of the method, as the registry has them
  int order = 0;                              ///< theoretical
  bool multistep = false;                     ///< it forgets its history at each exchange
  std::string setting_name;                   ///< "rtol", "step_s" or "tick_s"
  double setting = 0.0;                       ///< its value
  /// relative tolerance of the method's own error test; NaN where it has none
  double error_test_rtol = std::numeric_limits<double>::quiet_NaN();
  bool coarsest = false;      ///< a coarser setting makes no sense
  bool open_ended = false;    ///< of a default ladder, which ends where the reference cannot tell errors
  std::string linear_solver;  ///< empty: it solves no linear systems
  std::string against;        ///< integrator of the reference that it is held against: not its own method
  scene::Description description;              ///< the scene with everything set for this point
  PointStatus status = PointStatus::kMissing;  ///< how it ended
  std::string reason;                          ///< where the status is not kOk
  /// NaN throughout where the status is not kOk, or where there is no reference
  TrajectoryError error;
  loop::RunResult result;     ///< of the first repeat; counts are the same in all
  std::vector<double> cpu_s;  ///< of each repeat: the loop's, without assembly and recording
  double cpu_median_s = 0.0, cpu_min_s = 0.0, cpu_max_s = 0.0;  ///< of all repeats
  double setup_s = 0.0, record_s = 0.0;  ///< of the first repeat: assembly; recording and the bodies' energy
  /// of the first repeat: the loop without contact queries, linearisations and ticks
  double method_s() const { return result.cpu_s - result.query_s - result.linearise_s - result.tool_s; }
  /// whether the position error is less than kResolution times the reference's own: not to be trusted
  bool unresolved = false;
  bool force_unresolved = false;   ///< likewise for the RMS of the force on the hand
  bool torque_unresolved = false;  ///< likewise for that of the torque
};

/// The reference that the points are compared with, and how far it can be trusted.
struct Reference {
  std::string description;  ///< integrators of the reference and of its check
  std::string trouble;      ///< what is missing of the two, and why; empty: nothing
  bool available = false;   ///< without one no point has an error
  /// distance of two families at tight tolerance; NaN where there was no check
  TrajectoryError own_error = no_distance();
  double peak_force_n = 0.0, peak_torque_n_m = 0.0;  ///< on the hand
  double cpu_s = 0.0;                                ///< of the reference and its check
};

/// One method of finding the tool's contact, compared with the first of the scene's list: how far the choice
/// of method moves the result.
struct MethodPoint {
  std::string method;                 ///< as `contact.method` names it
  TrajectoryError difference;         ///< zero for the first
  double peak_force_n = 0.0;          ///< on the hand
  long most_samples = 0;              ///< contact samples at one time
  double query_s = 0.0, cpu_s = 0.0;  ///< of the contact queries; of the loop
  std::string trouble{};              ///< why the scene could not be run with it; empty: it was
};

/// A chart, or a part of one, that could not be made.
struct MissingChart {
  std::string of;   ///< "the contact methods", "the contact method \"gpu\""
  std::string why;  ///< in words, with what to do
  /// One sentence.
  std::string text() const { return "no chart of " + of + ": " + why; }
};

/// Everything about one scene.
struct SceneComparison {
  std::string scene, path;           ///< its name, and its file
  bool tool = false;                 ///< whether it has a tool
  Reference reference;               ///< what errors are distances from
  std::vector<ComparePoint> points;  ///< every rung of every ladder
  /// setting "contact_refresh_s": what re-initialisation costs; empty where the scene asks for none
  std::vector<ComparePoint> restarts;
  /// error of the exchange period itself; empty where the scene asks for none
  ExchangeStudy exchange;
  std::vector<MethodPoint> methods;          ///< those that could be run; empty where the scene names none
  std::vector<MissingChart> missing_charts;  ///< and why they are missing
  /// what LinearSolvers::kBest tried: each method's middle rung, by each solver; labels are the ladders'
  std::vector<ComparePoint> trials;
};

/// What `palpate compare` found.
struct Comparison {
  std::vector<SceneComparison> scenes;  ///< in the order in which they were given
  std::string rules;                    ///< how runs were repeated and limited, in words
  long reused = 0;                      ///< runs that an earlier, unfinished study had done
  bool stopped = false;                 ///< from outside: the rest of the points is missing
};

/// Which linear solver each implicit method is given.
enum class LinearSolvers {
  kSame,   ///< one for all (`linear_solver`), so that methods alone are compared
  kBest,   ///< each method's fastest, found by trying them at the middle rung of its ladder
  kNamed,  ///< the scene's own, or else what the method takes by itself
};

/// How `palpate compare` works.
struct CompareOptions {
  LinearSolvers linear_solvers = LinearSolvers::kSame;  ///< which one a method gets
  std::string linear_solver = "cholmod";                ///< of kSame: a direct one leaves no error of its own
  /// at most; a point is repeated only while its runs together took less than a fifth of the limit
  int repeats = 3;
  double limit_s = 10.0;             ///< CPU seconds a point
  double reference_limit_s = 120.0;  ///< CPU seconds of a reference, of its check, and of each further chart
  /// runs side by side; 0: references on all cores, and what is timed with nothing beside it
  int jobs = 0;
  /// names or labels; empty: the scene's ladders and all else that is not static
  std::vector<std::string> integrators;
  bool all = false;      ///< every integrator that is not static, beside those named
  std::string database;  ///< file to keep results in and to go on from; empty: none
  /// called after each run
  std::function<void(double fraction, const std::string& what)> progress;
  const std::atomic<bool>* stop = nullptr;  ///< set from outside: runs that have begun are ended
};

/// Runs every ladder of every scene at the scene's fixed exchange period against the scene's tight reference
/// (a method of the reference's own family against its check), each run in a process of its own; repeats are
/// interleaved over all points, so that a noisy machine hurts all alike.  The processes come from core's
/// ProcessPool: a program that has started threads or drawn a picture by now must have called
/// ProcessPool::prepare() before.
/// @param options  what is compared, how often, and within which limits
/// @param scenes  from loop::load or loop::parse: their text is what results are kept under
/// @throws Error for ladders that make no sense
Comparison run(const std::vector<scene::Description>& scenes, const CompareOptions& options);

/// Runs the scene with the tool's contact found by each method of `compare.contact_methods`, at the scene's
/// own integrator settings.  A method that is not available, or whose run gives up, is a point with its
/// trouble.
std::vector<MethodPoint> compare_contact_methods(const scene::Description& description,
                                                 const std::atomic<bool>* stop = nullptr);

/// Writes compare.csv, restarts.csv, exchange.csv, methods.csv and reference.json into `folder`: report reads
/// its tables, fitted orders and plots from them.
void write(const Comparison& comparison, const std::string& folder);

}  // namespace palpate::compare
