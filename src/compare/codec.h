#pragma once
#include "palpate/compare/compare.h"
#include "store/study_db.h"

namespace palpate::compare {

/// Serializes a run, including its trajectory.
std::string bytes_of(const Run& run);
/// Restores a run.
Run run_of(const std::string& bytes);

std::string bytes_of(const Trajectory& trajectory);
Trajectory trajectory_of(const std::string& bytes);

/// Reference that a point's error was measured against.
enum class ReferenceUsed { kNone, kPrimary, kCheck };

/// Result of one run of a point, as stored.
struct PointRun {
  ReferenceUsed reference = ReferenceUsed::kNone;
  PointStatus status = PointStatus::kMissing;
  std::string reason;
  TrajectoryError error = no_distance();
  double setup_s = 0.0, record_s = 0.0;  ///< CPU time [s], see Run.
  loop::RunResult result;
};
std::string bytes_of(const PointRun& run);
PointRun point_run_of(const std::string& bytes);

/// Columns of a PointRun in the study's database.
const std::vector<std::string>& run_columns();
/// Returns a PointRun as one row of the database.
store::StudyRun row_of(const PointRun& run, double limit_s);
/// Restores a PointRun from one row.
PointRun point_run_of(const store::StudyRun& row);
double limit_of(const store::StudyRun& row);  ///< CPU limit of the run [s].

std::string bytes_of(const ExchangeStudy& study);
ExchangeStudy exchange_of(const std::string& bytes);
std::string bytes_of(const std::vector<MethodPoint>& points);
std::vector<MethodPoint> methods_of(const std::string& bytes);

}  // namespace palpate::compare
