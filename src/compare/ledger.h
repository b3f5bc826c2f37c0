#pragma once
#include <deque>

#include "codec.h"
#include "plan.h"
#include "run.h"

namespace palpate::compare {

/// Reason of a level that was skipped as unnecessary; such levels are in no table.
inline const std::string kNotNeeded = "the reference cannot resolve finer errors";

/// Run to be made.
struct Task {
  enum class Kind { kPrimary, kCheck, kPoint, kRestart, kExchange, kMethods };
  Kind kind;
  std::size_t scene, point = 0;
  int repeat = 0;
  bool looked_up = false, started = false, done = false;  ///< looked_up: in the database.

  bool is_point() const { return kind == Kind::kPoint || kind == Kind::kRestart; }
  bool is_reference() const { return kind == Kind::kPrimary || kind == Kind::kCheck; }
};

/// State of one scene within a study.
struct SceneWork {
  scene::Description description;
  PlannedReference planned;
  std::string primary_key, check_key;
  ReferenceRun primary, check;
  bool reference_settled = false;
  std::vector<std::string> point_keys, restart_keys;
};

/// All runs of a study, and their results so far.
class Ledger {
 public:
  /// Plans the runs.
  /// @param choices  linear solvers per scene
  /// @param trials  plans trials of linear solvers instead of sequences and charts
  Ledger(const std::vector<scene::Description>& scenes, const CompareOptions& options,
         const std::vector<SolverChoice>& choices, bool trials);

  std::deque<Task> tasks;       ///< In order of preference; addresses of tasks are stable.
  std::vector<SceneWork> work;  ///< Per scene.
  Comparison out;

  const CompareOptions& options() const { return options_; }
  ComparePoint& point_of(const Task& task);
  /// Returns the level that is `by` levels coarser in the same sequence, or null.
  const ComparePoint* coarser(const Task& task, std::size_t by) const;
  const std::string& key_of(const Task& task) const;  ///< Key of a point's runs in the database.
  std::string artefact_key(const Task& task) const;   ///< Key of all other results in the database.
  /// Returns the CPU limit of a task [s].
  double limit_of(const Task& task) const {
    return task.is_point() ? options_.limit_s : options_.reference_limit_s;
  }

  /// Whether all inputs of the task are available: the reference, the next coarser level, the first of its
  /// repeats.
  bool is_ready(const Task& task);
  /// Settles one point that needs no run; returns true where the task is to be skipped.
  bool is_pointless(const Task& task);

  /// Takes a run's result, whether resumed or new.
  void take(const Task& task, const store::StudyRun& row);
  void take(const Task& task, const store::StudyArtefact& kept);
  /// Returns false for a chart with missing parts: the cause (a library, a display) may be resolved by now,
  /// so the chart is made again.
  static bool is_complete(const Task& task, const store::StudyArtefact& kept);
  /// Returns the reference for a point's error: the primary one, or its check where the method is of the
  /// primary's family and shares its errors; the other one where one failed.
  ReferenceUsed reference_used(const Task& task) const;
  const Trajectory* reference_of(const Task& task) const;  ///< Null where there is none.

  /// Decides, for scenes whose two reference runs have ended, which one is the reference, and its error.
  void settle_references();
  /// Computes medians, marks and texts, when no run is left.  @param jobs  number of parallel runs
  void finish(int jobs);

 private:
  void plan(const scene::Description& description, const SolverChoice& choice);
  void add_tasks();
  void take_chart(const Task& task, const store::StudyArtefact& kept);
  /// Returns the number of coarser levels in the same sequence.
  std::size_t level(std::size_t scene, std::size_t point) const;
  bool reference_tasks_done(std::size_t scene) const;
  bool is_at_the_end(const Task& task) const;
  const CompareOptions& options_;
  bool trials_;
};

}  // namespace palpate::compare
