#pragma once
#include "palpate/compare/compare.h"
#include "palpate/store/study_db.h"

namespace palpate::compare {

/// A run as bytes, trajectory and all, and back.
std::string bytes_of(const Run& run);
Run run_of(const std::string& bytes);

std::string bytes_of(const Trajectory& trajectory);
Trajectory trajectory_of(const std::string& bytes);

/// The reference that a point's error was measured against.
enum class ReferenceUsed { kNone, kPrimary, kCheck };

/// Result of one run of a point, as it is stored.
struct PointRun {
  ReferenceUsed reference = ReferenceUsed::kNone;
  PointStatus status = PointStatus::kMissing;
  std::string reason;
  TrajectoryError error = no_distance();
  double setup_s = 0.0, record_s = 0.0;  ///< CPU time, see Run
  loop::RunResult result;
};
std::string bytes_of(const PointRun& run);
PointRun point_run_of(const std::string& bytes);

/// A PointRun as a row of the study's database, under the columns run_columns().
const std::vector<std::string>& run_columns();
store::StudyRun row_of(const PointRun& run, double limit_s);
PointRun point_run_of(const store::StudyRun& row);
double limit_of(const store::StudyRun& row);  ///< CPU limit that the run had [s]

std::string bytes_of(const ExchangeStudy& study);
ExchangeStudy exchange_of(const std::string& bytes);
std::string bytes_of(const std::vector<MethodPoint>& points);
std::vector<MethodPoint> methods_of(const std::string& bytes);

}  // namespace palpate::compare
