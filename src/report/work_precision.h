#pragma once
#include <limits>
#include <string>
#include <vector>

#include "report/answer.h"
#include "report/plot.h"
#include "report/table.h"

/// Evaluation of a work-precision comparison, read from compare.csv (columns: store::compare_columns()).  All
/// functions take the lines of one scene.
namespace palpate::report {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Target errors of every comparison.
inline const std::vector<double> kTargets = {1e-2, 1e-3, 1e-4, 1e-6};
/// Baseline: the interactive method of the field; for anything slower than it the factor is reported.
inline const std::string kBaseline = "linearly-implicit-euler";

/// Columns of exchange.csv, in order (a `scene` may stand before them).
const std::vector<std::string>& exchange_columns();

/// The reference's own error (reference.json): two families' difference.  NaN where not measured.
struct ReferenceError {
  double position_error_rel_l2 = kUnknown;
  double force_error_rms_n = kUnknown;
  double torque_error_rms_n_m = kUnknown;
  double peak_force_n = kUnknown, peak_torque_n_m = kUnknown;  ///< of the reference
  std::string description = {};
  std::string trouble = {};             ///< what is missing of it, and why
  std::vector<std::string> notes = {};  ///< charts that could not be made
};

/// The lines whose cell in `column` is `value`; all of them where there is no such column.
Table rows_where(const Table& table, const std::string& column, const std::string& value);
/// The distinct values of a column, in the order of the lines.
std::vector<std::string> distinct(const Table& table, const std::string& column);

/// One ladder: its usable points, from the coarsest rung to the finest.
struct LadderPoint {
  double setting = kUnknown, error = kUnknown, cost = kUnknown;
  double cost_low = kUnknown, cost_high = kUnknown;  ///< of the repeats
  bool unresolved = false;
  bool behind_failure = false;  ///< the rung before it failed, at the setting
  double failed_before = kUnknown;
};
struct Ladder {
  std::string label, integrator, family, stability, setting_name;
  int order = 0;                    ///< theoretical
  bool coarsest_tried = false;      ///< no setting coarser than the first rung's makes sense
  std::vector<LadderPoint> points;  ///< those with status ok and a finite error
  std::vector<std::pair<std::string, std::string>> failures = {};  ///< status and reason of the others
  std::vector<double> failed_settings = {};
};
std::vector<Ladder> ladders(const Table& compare, const std::string& error_column,
                            const std::string& cost_column);

/// Least-squares slope of log(error) against log(setting) of one ladder.
struct FittedOrder {
  std::string label, integrator, setting_name;
  double order = kUnknown;  ///< NaN with fewer than two usable points
  int points = 0;           ///< that were used: status ok, finite, not unresolved
};
/// @param scale  size of what errs, in the error's unit: an error as large has no slope; NaN: unknown
std::vector<FittedOrder> fitted_orders(const Table& compare, const std::string& error_column,
                                       double scale = 1.0);

/// Errors closer to the reference's own than this decide nothing (compare marks them, compare.h).
inline constexpr double kResolved = 10.0;

/// Cost of an error on one ladder, on monotone envelopes of its rungs (cost_envelope.cpp).  Nothing is
/// extrapolated, nor interpolated across rungs that failed: there the next finer rung's cost is an upper
/// bound (`at_most`).
struct Cost {
  double value = kUnknown;                 ///< NaN: not reached, or not resolved by the reference
  double low = kUnknown, high = kUnknown;  ///< by repeats and by rungs out of line
  bool at_most = false;
};
/// @param reference_error  the reference's own; NaN: nothing has a cost
Cost cost_at(const Ladder& ladder, double target, double reference_error);
std::string cost_text(const Cost& cost);    ///< "0.12", "<= 0.12", "-"
std::string spread_text(const Cost& cost);  ///< "0.11 to 0.14"

/// A cost over another.
struct CostRatio {
  double value = kUnknown, low = kUnknown, high = kUnknown;
};
std::string ratio_text(const CostRatio& ratio);  ///< "1.50 (1.31 to 1.72)", "-"

/// The ladder that reaches an error at the least cost.
struct Winner {
  double target = 0.0;
  bool resolved = false;  ///< the reference can tell such errors
  bool found = false;     ///< some ladder reaches it
  std::string label, runner_up;
  Cost cost;
  CostRatio runner_up_ratio;        ///< its cost over the cheapest's
  CostRatio baseline_ratio;         ///< of kBaseline; NaN where it does not reach the error
  std::vector<std::string> rivals;  ///< whose spread overlaps the cheapest's: with any, nothing is declared
  bool declared() const { return found && rivals.empty(); }
};
/// @param reference_error  the reference's own; NaN: nothing is declared
std::vector<Winner> winners(const Table& compare, const std::string& error_column,
                            const std::string& cost_column, const std::vector<double>& targets,
                            double reference_error);

/// Which ladder is cheapest at each wanted error, with its margin: of positions, and where there is one of
/// the force on the hand.
std::vector<Answer> cheapest_in_words(const Table& compare, const ReferenceError& reference);

/// How far those answers go: which methods failed and why, which explicit ones are at their stability limit,
/// and whether the reference is good enough.  One paragraph each.
std::vector<std::string> remarks_in_words(const Table& compare, const ReferenceError& reference);

/// The numbers as sentences: which ladder wins where, for positions and for the force on the hand, which
/// failed and why, which explicit methods are at their stability limit, and whether the reference is good
/// enough.  Paragraphs are separate lines.
std::string in_words(const Table& compare, const ReferenceError& reference);

/// Errors are drawn up to this many times the size of what errs: one far above it says only that the run is
/// wrong, and would compress the others.
inline constexpr double kLargestDrawn = 3.0;
/// How many points work_precision_plot() leaves out for that.
/// @param scale  size of what errs, in the error's unit: 1 of a relative error; NaN: unknown, all are drawn
int points_not_drawn(const Table& compare, const std::string& error_column, double scale);

/// Error against a cost, log-log: one line per ladder, coloured by family; the best envelope is drawn over
/// them.
Plot work_precision_plot(const Table& compare, const std::string& error_column,
                         const std::string& error_label, double reference_error, double scale = 1.0,
                         const std::string& cost_column = "cpu_s_median",
                         const std::string& cost_label = "CPU time [s]");

/// Error against a cost in one small plot a family: its ladders in colour with their names, all others faint
/// behind.
std::vector<Plot> family_plots(const Table& compare, const std::string& error_column,
                               const std::string& error_label, double reference_error, double scale = 1.0,
                               const std::string& cost_column = "cpu_s_median",
                               const std::string& cost_label = "CPU time [s]");

/// Error against the exchange period, log-log, with the fitted slope drawn beside it.
Plot exchange_plot(const Table& exchange, const std::string& error_column, const std::string& error_label);

/// Plot of restarts.csv: `count_column` per simulated second against the restarts per simulated second;
/// multistep methods in colour, one-step ones grey.
Plot restart_plot(const Table& restarts, const std::string& count_column, const std::string& count_label);

/// "rtol 1e-04", "step 2 ms": a ladder point's setting for people.
std::string setting_text(const std::string& setting_name, double setting);

}  // namespace palpate::report
