#pragma once
#include <map>

#include "experiments/compare/plan.h"
#include "experiments/compare/run.h"
#include "experiments/engine.h"

namespace palpate::compare {

/// Reason of a level that was skipped as unnecessary; such levels are in no table.
inline const std::string kNotNeeded = "the reference cannot resolve finer errors";

/// Run to be made.
struct Task {
  enum class Kind { kPrimary, kCheck, kPoint, kRestart, kExchange, kMethods };
  Kind kind;
  std::size_t scene, point = 0;
  int repeat = 0;
  std::size_t group = 0;  ///< Equal for the levels and repeats of one sequence.

  bool is_point() const { return kind == Kind::kPoint || kind == Kind::kRestart; }
  bool is_reference() const { return kind == Kind::kPrimary || kind == Kind::kCheck; }
};

/// State of one scene within a comparison.
struct SceneWork {
  scene::Description description;
  PlannedReference planned;
  std::string primary_key, check_key, exchange_key, methods_key;
  ReferenceRun primary, check;
  int references_taken = 0;
  bool reference_settled = false;
  std::vector<std::string> point_keys, restart_keys;
};

/// All runs of a comparison, and their results so far.
class ComparisonTasks : public experiments::Experiment {
 public:
  /// Plans the runs.
  /// @param choices  linear solvers per scene
  /// @param trials  plans trials of linear solvers instead of sequences and charts
  ComparisonTasks(const std::vector<scene::Description>& scenes, const CompareOptions& options,
                  const std::vector<SolverChoice>& choices, bool trials);

  std::size_t size() const override { return tasks_.size(); }
  experiments::Task task(std::size_t i) override;
  std::string input(std::size_t i) override;
  void take(std::size_t i, const experiments::Result& result) override;
  /// Settles one point that needs no run; returns false where the task is to be skipped.
  bool is_wanted(std::size_t i) override { return !is_pointless(tasks_[i]); }
  /// Returns whether all inputs of the task are available: the reference, the next coarser level, the first
  /// of its repeats.
  bool is_ready(std::size_t i) override;
  /// Returns false for a chart with missing parts: the cause (a library, a display) may be resolved later, so
  /// the chart is made again.  True for one that ran out of time, which is made again under a larger limit.
  bool is_final(std::size_t i, const experiments::Result& result) override;
  bool has_dependencies() const override { return true; }
  std::size_t group(std::size_t i) override { return tasks_[i].group; }
  std::string progress_text(std::size_t i) override;
  std::string key() override;

  /// Computes medians, marks and texts, when no run is left.
  Comparison finish();

 private:
  /// Reference that a point's error is measured against.
  enum class ReferenceUsed { kNone, kPrimary, kCheck };

  void plan(const scene::Description& description, const SolverChoice& choice);
  void add_tasks();
  void add_task(Task task);
  ComparePoint& point_of(const Task& task);
  /// Returns the level that is `by` levels coarser in the same sequence, or null.
  const ComparePoint* coarser(const Task& task, std::size_t by) const;
  std::string key_of(const Task& task) const;
  double limit_of(const Task& task) const {
    return task.is_point() ? options_.limit_s : options_.reference_limit_s;
  }
  bool is_pointless(const Task& task);
  /// Returns the reference for a point's error: the primary one, or its check where the method is of the
  /// primary's family and shares its errors; the other one where one failed.
  ReferenceUsed reference_used(const Task& task) const;
  const Trajectory* reference_of(const Task& task) const;  ///< Null where there is none.
  void take_reference(const Task& task, const experiments::Result& result);
  void take_point(const Task& task, const experiments::Result& result);
  void take_chart(const Task& task, const experiments::Result& result);
  /// Returns the number of coarser levels in the same sequence.
  std::size_t level(std::size_t scene, std::size_t point) const;
  bool is_at_the_end(const Task& task) const;
  std::string rules() const;

  const CompareOptions& options_;
  bool trials_;
  std::vector<Task> tasks_;                                            ///< In order of preference.
  std::map<std::pair<std::size_t, std::string>, std::size_t> groups_;  ///< By scene and label.
  std::vector<SceneWork> work_;                                        ///< Per scene.
  Comparison out_;
};

}  // namespace palpate::compare
