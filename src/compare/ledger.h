#pragma once
#include <deque>

#include "codec.h"
#include "plan.h"
#include "run.h"

namespace palpate::compare {

/// Why a rung was left out that nobody misses; it is in no table.
inline const std::string kNotNeeded = "the reference cannot tell finer errors";

/// One run that is to be made.
struct Task {
  enum class Kind { kPrimary, kCheck, kPoint, kRestart, kExchange, kMethods };
  Kind kind;
  std::size_t scene, point = 0;
  int repeat = 0;
  bool looked_up = false, started = false, done = false;  ///< looked_up: in the database

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
  /// @param choices  of each scene  @param trials  instead of ladders and charts: which solver is fastest
  Ledger(const std::vector<scene::Description>& scenes, const CompareOptions& options,
         const std::vector<SolverChoice>& choices, bool trials);

  std::deque<Task> tasks;       ///< in the order in which they are wanted; a task stays where it is
  std::vector<SceneWork> work;  ///< of each scene
  Comparison out;

  const CompareOptions& options() const { return options_; }
  ComparePoint& point_of(const Task& task);
  /// the rung so many before it, or null
  const ComparePoint* coarser(const Task& task, std::size_t by) const;
  const std::string& key_of(const Task& task) const;  ///< of a point's runs in the database
  std::string artefact_key(const Task& task) const;   ///< of all else
  double limit_of(const Task& task) const {
    return task.is_point() ? options_.limit_s : options_.reference_limit_s;
  }

  /// Whether all that the task needs is there: the reference, the rung before it, the first of its repeats.
  bool is_ready(const Task& task);
  /// Settles a point that needs no run of its own; true where the task is to be left out.
  bool is_pointless(const Task& task);

  /// Takes a run's result, from the database or on its way there.
  void take(const Task& task, const store::StudyRun& row);
  void take(const Task& task, const store::StudyArtefact& kept);
  /// False for a chart that lacks something: what was missing (a library, a display) may be there today, so
  /// the chart is made again.
  static bool is_whole(const Task& task, const store::StudyArtefact& kept);
  /// What a point's error is measured against: the reference, or its check where the method is of the
  /// reference's own family, and shares what error it has; and the other where one failed.
  ReferenceUsed reference_used(const Task& task) const;
  const Trajectory* reference_of(const Task& task) const;  ///< null: there is none

  /// Once a scene's two reference runs have ended, decides which is the reference and how far it can be
  /// trusted.
  void settle_references();
  /// Computes medians, marks and texts, once nothing is left to run.  @param jobs  number of runs side by
  /// side
  void finish(int jobs);

 private:
  void plan(const scene::Description& description, const SolverChoice& choice);
  void add_tasks();
  void take_chart(const Task& task, const store::StudyArtefact& kept);
  /// how many rungs of the same ladder come before it
  std::size_t rung(std::size_t scene, std::size_t point) const;
  bool reference_tasks_done(std::size_t scene) const;
  bool is_at_the_end(const Task& task) const;
  const CompareOptions& options_;
  bool trials_;
};

}  // namespace palpate::compare
