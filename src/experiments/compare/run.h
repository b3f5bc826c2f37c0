#pragma once
#include <optional>

#include "experiments/compare/plan.h"
#include "experiments/task.h"

namespace palpate::compare {

/// One run of a point.
struct PointRun {
  TrajectoryError error = no_distance();
  double setup_s = 0.0, record_s = 0.0;  ///< CPU time [s], see Run.
  loop::RunResult result;

  void archive(Archive& a);
};

/// Returns the reason of a run that was interrupted.
std::string out_of_time_reason(double limit_s, const loop::RunResult& result);

/// Runs one point, in a separate process.
/// @param reference  null: no error is measured
/// @param out_of_time  becomes true after `limit_s`
/// @return status, reason, CPU time, and a PointRun
experiments::Result run_point(const scene::Description& description, double limit_s,
                              const Trajectory* reference, const std::atomic<bool>* out_of_time);

/// Result of one of the two reference runs, or the reason why there is none.
struct ReferenceRun {
  std::optional<Run> run;  ///< Only where it reached its end.
  std::string trouble;
};

/// Decides which run is the reference, and computes the reference error.  The check replaces a reference that
/// failed.  @param measure  distance of the check from the reference
Reference settle(const PlannedReference& planned, const ReferenceRun& primary, const ReferenceRun& check,
                 TrajectoryError (*measure)(const Trajectory&, const Trajectory&) = distance);

}  // namespace palpate::compare
