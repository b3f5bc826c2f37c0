#pragma once
#include <limits>
#include <string>
#include <vector>

#include "report/table.h"

/// Evaluation of a work-precision comparison, read from compare.csv (columns: store::compare_columns()). All
/// functions take the lines of one scene.
namespace palpate::report {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Target errors of every comparison, relative.
inline const std::vector<double> kTargets = {1e-2, 1e-3, 1e-4, 1e-6};
/// Returns the targets for a quantity of this size, in its unit.
std::vector<double> targets_of(double scale);
/// Peaks of forces and torques below it are rounding [N], [N m].
inline constexpr double kLeastPeak = 1e-12;
/// Baseline: the standard interactive method; the cost ratio of slower methods to it is reported.
inline const std::string kBaseline = "linearly-implicit-euler";

/// Columns of errors.
inline constexpr const char *kPosition = "position_error_rel_l2", *kForce = "force_error_rms_n";

/// Returns the columns of exchange.csv, in order (a column `scene` may precede them).
const std::vector<std::string>& exchange_columns();

/// Error of the reference (reference.json): difference between two families of methods. NaN if not measured.
struct ReferenceError {
  double position_error_rel_l2 = kUnknown;
  double force_error_rms_n = kUnknown;
  double torque_error_rms_n_m = kUnknown;
  double peak_force_n = kUnknown, peak_torque_n_m = kUnknown;  ///< Peaks of the reference
  std::string description = {};
  std::string trouble = {};             ///< Missing part of the reference, and the reason
  std::vector<std::string> notes = {};  ///< Charts that could not be made
};

/// Usable point of a refinement sequence.
struct LadderPoint {
  double setting = kUnknown, error = kUnknown, cost = kUnknown;
  double cost_low = kUnknown, cost_high = kUnknown;  ///< Least and largest cost over the repeats
  bool unresolved = false;                           ///< Whether the reference cannot resolve the error
  bool behind_failure = false;                       ///< Whether the level before it failed
  double failed_before = kUnknown;                   ///< Setting of that level
};
/// Refinement sequence of one method: its usable points, from the coarsest level to the finest.
struct Ladder {
  std::string label, integrator, family, stability, setting_name;
  int order = 0;                    ///< Theoretical order
  bool coarsest_tried = false;      ///< Whether no coarser setting than the first level is meaningful
  std::vector<LadderPoint> points;  ///< Points with status ok and a finite error
  std::vector<std::pair<std::string, std::string>> failures = {};  ///< Status and reason of the failed points
  std::vector<double> failed_settings = {};
};
/// Returns the refinement sequences of a comparison, one per label.
std::vector<Ladder> ladders(const Table& compare, const std::string& error_column,
                            const std::string& cost_column);

/// Least-squares slope of log(error) against log(setting) of one refinement sequence.
struct FittedOrder {
  std::string label, integrator, setting_name;
  double order = kUnknown;  ///< NaN with fewer than two usable points
  int points = 0;  ///< Points used: status ok, finite, resolved by the reference, error below the scale
};
/// Fits the order of each refinement sequence.
/// @param scale  size of the erring quantity, in the unit of the error: errors of that size or larger are
/// excluded; NaN: unknown
std::vector<FittedOrder> fitted_orders(const Table& compare, const std::string& error_column,
                                       double scale = 1.0);

/// Returns the setting of a point as readable text: "1e-4" for rtol, "2 ms" for a step or tick.
std::string setting_text(const std::string& setting_name, double setting);

}  // namespace palpate::report
