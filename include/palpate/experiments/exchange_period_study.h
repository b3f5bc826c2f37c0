#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "palpate/experiments/trajectory.h"

namespace palpate::compare {

/// Result of one exchange period of a scene with a tool, against the monolithic solution.
struct ExchangePoint {
  double exchange_period_s = 0.0;  ///< Exchange period [s].
  TrajectoryError error;           ///< NaN throughout when the run, or the reference, failed.
  double cpu_s = 0.0;              ///< CPU time of the run [s].
  std::string trouble{};           ///< Reason why there is no error; empty: there is one.
  /// Whether the errors are less than kResolution times the reference error.
  bool unresolved = false, force_unresolved = false, torque_unresolved = false;

  void archive(Archive& a);  ///< Writes the values to an archive, or restores them.
};

/// Result of an exchange study.
struct ExchangeStudy {
  std::vector<ExchangePoint> points;          ///< In the scene's order.
  std::string made_by = {}, checked_by = {};  ///< Descriptions of the reference and of its check.
  /// Reference error: distance of the two; NaN without a check.
  TrajectoryError own_error = no_distance();
  std::string trouble = {};  ///< Reason why there was no check.

  void archive(Archive& a);  ///< Writes the values to an archive, or restores them.
};

/// Options of an exchange study.
struct ExchangeOptions {
  std::function<void(const std::string& what)> done;  ///< Called after each run.
  const std::atomic<bool>* stop = nullptr;            ///< Set from outside: no further run.
  /// Modifies each partitioned World after assembly: seeds a defect that the study must detect (tests).
  std::function<void(loop::World& world)> seed_defect = {};
};

/// Returns the number of runs of compare_exchange: 0 without a tool or without `compare.exchange_periods_s`.
int exchange_runs(const scene::Description& description);

/// Measures the error of the exchange period alone: the distance of the partitioned scheme at each of
/// `compare.exchange_periods_s` from the monolithic solution.  Everything else is equal in both: the same
/// tight cvode-bdf, one contact refresh period (the longest that divides every exchange period), and a
/// tick of a tenth of the exchange period.  The scheme is of order 1 in the period where the handle's path is
/// smooth.  The monolithic solution is repeated with a method of another family and another factorisation:
/// their distance is the reference error.  Empty where the scene requests none; stops early on request.
ExchangeStudy compare_exchange(const scene::Description& description, const ExchangeOptions& options);

}  // namespace palpate::compare
