#pragma once
#include <string>
#include <vector>

#include "report/plot.h"
#include "report/table.h"
#include "report/work_precision.h"

/// Charts of a comparison.
namespace palpate::report {

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

}  // namespace palpate::report
