#pragma once
#include <limits>
#include <string>
#include <vector>

#include "palpate/report/plot.h"
#include "palpate/report/table.h"

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
  std::string description;
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
  bool unresolved = false;
};
struct Ladder {
  std::string label, integrator, family, stability, setting_name;
  int order = 0;                    ///< theoretical
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
std::vector<FittedOrder> fitted_orders(const Table& compare, const std::string& error_column);

/// Cost of an error on one ladder.  Between two neighbouring rungs whose errors enclose it, log(cost) is
/// taken as linear in log(error); the cheapest such pair counts.  Nothing is extrapolated: where even the
/// coarsest usable rung is better, its own cost is an upper bound (`at_most`).  An error below the
/// reference's own counts as that.
struct Cost {
  double value = kUnknown;  ///< NaN: not reached
  bool at_most = false;
};
Cost cost_at(const Ladder& ladder, double target, double reference_error);
std::string cost_text(const Cost& cost);  ///< "0.12", "<= 0.12", "-"

/// The ladder that reaches an error at the least cost.
struct Winner {
  double target = 0.0;
  bool found = false;
  std::string label, runner_up;
  Cost cost;
  double runner_up_ratio = kUnknown;  ///< its cost over the winner's
  double baseline_ratio =
      kUnknown;  ///< cost of kBaseline over the winner's; NaN where it does not reach the error
};
std::vector<Winner> winners(const Table& compare, const std::string& error_column,
                            const std::string& cost_column, const std::vector<double>& targets,
                            double reference_error = kUnknown);

/// The numbers as sentences: which ladder wins where, which failed and why, which explicit methods are at
/// their stability limit, and whether the reference is good enough.  Paragraphs are separate lines.
std::string in_words(const Table& compare, double reference_error);

/// Error against a cost, log-log: one line a ladder, coloured by family; the best envelope is drawn over
/// them.
Plot work_precision_plot(const Table& compare, const std::string& error_column,
                         const std::string& error_label, double reference_error,
                         const std::string& cost_column = "cpu_s_median",
                         const std::string& cost_label = "CPU time [s]");

/// Error against a cost in one small plot a family: its ladders in colour with their names, all others faint
/// behind.
std::vector<Plot> family_plots(const Table& compare, const std::string& error_column,
                               const std::string& error_label, double reference_error,
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
