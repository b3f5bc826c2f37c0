#pragma once
#include <limits>
#include <string>
#include <vector>

#include "report/answer.h"
#include "report/plot.h"
#include "report/table.h"

/// Evaluation of a work-precision comparison, read from compare.csv (columns: store::compare_columns()). All
/// functions take the lines of one scene.
namespace palpate::report {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Target errors of every comparison, relative.
inline const std::vector<double> kTargets = {1e-2, 1e-3, 1e-4, 1e-6};
/// Baseline: the standard interactive method; the cost ratio of slower methods to it is reported.
inline const std::string kBaseline = "linearly-implicit-euler";

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

/// Returns the lines whose cell in `column` is `value`; all lines if there is no such column.
Table rows_where(const Table& table, const std::string& column, const std::string& value);
/// Returns the distinct values of a column, in the order of the lines.
std::vector<std::string> distinct(const Table& table, const std::string& column);

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

/// Ratio to the error of the reference below which errors are not resolved and do not affect a decision
/// (compare marks them, compare.h).
inline constexpr double kResolved = 10.0;

/// Cost of an error on one refinement sequence, from monotone envelopes of its levels (cost_envelope.cpp).
/// Costs are neither extrapolated nor interpolated across failed levels: there the cost of the next finer
/// level is an upper bound (`at_most`).
struct Cost {
  double value = kUnknown;                 ///< NaN: error not reached, or not resolved by the reference
  double low = kUnknown, high = kUnknown;  ///< By repeats and non-monotone levels
  bool at_most = false;                    ///< Whether `value` is an upper bound
};
/// Returns the cost of a target error.
/// @param reference_error  error of the reference; NaN: no error has a cost
Cost cost_at(const Ladder& ladder, double target, double reference_error);
std::string cost_text(const Cost& cost);    ///< "0.12", "<= 0.12", "-"
std::string spread_text(const Cost& cost);  ///< "0.11 to 0.14"

/// Ratio of two costs.
struct CostRatio {
  double value = kUnknown, low = kUnknown, high = kUnknown;
};
std::string ratio_text(const CostRatio& ratio);  ///< "1.50 (1.31 to 1.72)", "-"

/// Refinement sequence that reaches an error at the least cost.
struct Winner {
  double target = 0.0;
  bool resolved = false;  ///< Whether the reference resolves errors of this size
  bool found = false;     ///< Whether any sequence reaches the target
  std::string label, runner_up;
  Cost cost;
  CostRatio runner_up_ratio;  ///< Cost of the runner-up over the cheapest cost
  CostRatio baseline_ratio;   ///< Cost of kBaseline over the cheapest cost; NaN if kBaseline does not reach
                              ///< the error
  std::vector<std::string> rivals;  ///< Labels whose spread overlaps the cheapest: no winner
  bool declared() const { return found && rivals.empty(); }
};
/// Returns the cheapest sequence at each target.
/// @param reference_error  error of the reference; NaN: no winner is declared
std::vector<Winner> winners(const Table& compare, const std::string& error_column,
                            const std::string& cost_column, const std::vector<double>& targets,
                            double reference_error);
/// Returns the row of a target in a table: target, winner, cost, range, runner-up, and the two ratios.
/// @param shown  target as shown
/// @param ranked  text of the winner, where a sequence reaches the target
std::vector<std::string> winner_row(const Winner& win, double shown, const std::string& ranked);

/// Returns sentences on which method is cheapest at each target error, with its margin, for positions and, if
/// present, for the force on the hand.
std::vector<Answer> cheapest_in_words(const Table& compare, const ReferenceError& reference);

/// Returns remarks on the limits of these answers, one paragraph per remark: which methods failed and why,
/// which explicit methods are at their stability limit, and whether the reference is accurate enough.
std::vector<std::string> remarks_in_words(const Table& compare, const ReferenceError& reference);

/// Returns the results as sentences: which method is cheapest at each target, for positions and for the force
/// on the hand, which failed and why, which explicit methods are at their stability limit, and whether the
/// reference is accurate enough. Paragraphs are separate lines.
std::string in_words(const Table& compare, const ReferenceError& reference);

/// Largest drawn error, in sizes of the erring quantity: a larger error shows only that the run is wrong, and
/// would compress the other curves.
inline constexpr double kLargestDrawn = 3.0;
/// Returns the number of points that work_precision_plot() leaves out for that reason.
/// @param scale  size of the erring quantity, in the unit of the error: 1 for a relative error; NaN: unknown,
/// all points are drawn
int points_not_drawn(const Table& compare, const std::string& error_column, double scale);

/// Plots error against a cost, log-log: one line per refinement sequence, coloured by family, and the best
/// envelope over them. With few sequences each point has its setting as a label instead.
Plot work_precision_plot(const Table& compare, const std::string& error_column,
                         const std::string& error_label, double reference_error, double scale = 1.0,
                         const std::string& cost_column = "cpu_s_median",
                         const std::string& cost_label = "CPU time [s]");

/// Plots error against a cost in one small plot per family (large families: per order): its sequences in
/// colour with their names, all others faint in the background.
std::vector<Plot> family_plots(const Table& compare, const std::string& error_column,
                               const std::string& error_label, double reference_error, double scale = 1.0,
                               const std::string& cost_column = "cpu_s_median",
                               const std::string& cost_label = "CPU time [s]");

/// Plots error against the exchange period, log-log, with a line of the fitted slope.
Plot exchange_plot(const Table& exchange, const std::string& error_column, const std::string& error_label);

/// Plots restarts.csv: `count_column` per simulated second against the contact refreshes per simulated
/// second; multistep methods as solid lines, one-step methods dashed.
Plot restart_plot(const Table& restarts, const std::string& count_column, const std::string& count_label);

/// Returns the setting of a point as readable text: "1e-4" for rtol, "2 ms" for a step or tick.
std::string setting_text(const std::string& setting_name, double setting);

}  // namespace palpate::report
