#pragma once
#include <optional>

#include "codec.h"
#include "plan.h"

namespace palpate::compare {

/// Runs one point, in a separate process.
/// @param reference  null: no error is measured
/// @param out_of_time  becomes true after `limit_s`
PointRun run_point(const scene::Description& description, double limit_s, const Trajectory* reference,
                   const std::atomic<bool>* out_of_time);

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
