#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "palpate/compare/trajectory.h"

namespace palpate::compare {

/// One exchange period of a scene with a tool, against the monolithic reference.
struct ExchangePoint {
  double exchange_period_s = 0.0;  ///< its length
  TrajectoryError error;           ///< NaN throughout when the run, or the one it is held against, failed
  double cpu_s = 0.0;              ///< of the run
  std::string trouble{};           ///< why there is no error; empty: there is one
  /// whether the errors are less than ten times the reference's own
  bool unresolved = false, force_unresolved = false, torque_unresolved = false;
};

/// What an exchange study found.
struct ExchangeStudy {
  std::vector<ExchangePoint> points;          ///< in the scene's order
  std::string made_by = {}, checked_by = {};  ///< the reference and its check, in words
  /// distance of the two; NaN where there was no check
  TrajectoryError own_error = no_distance();
  std::string trouble = {};  ///< why there was none
};

/// Options of an exchange study.
struct ExchangeOptions {
  std::function<void(const std::string& what)> done;  ///< after each run
  const std::atomic<bool>* stop = nullptr;            ///< set from outside: no further run
  /// changes each partitioned World once it is assembled: a defect that the study must find
  std::function<void(loop::World& world)> spoil = {};
};

/// Runs that compare_exchange makes of a scene: 0 without a tool or without `compare.exchange_periods_s`.
int exchange_runs(const scene::Description& description);

/// The error that the exchange period makes by itself: the distance of the partitioned scheme at each of
/// `compare.exchange_periods_s` from the monolithic one.  Everything else is alike in both: they are
/// integrated by the same tight cvode-bdf, the contact is refreshed at one period for all (the longest that
/// divides every exchange period), and the tool's tick is a tenth of the exchange period.  The scheme is of
/// order 1 in the period where the handle is smooth.  The monolithic run is made once more by a method of
/// another family with another factorisation: their distance is the reference's own error.  Empty where the
/// scene asks for none; stops early on request.
ExchangeStudy compare_exchange(const scene::Description& description, const ExchangeOptions& options);

}  // namespace palpate::compare
