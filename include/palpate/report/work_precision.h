#pragma once
#include <limits>
#include <string>
#include <vector>

#include "palpate/report/plot.h"
#include "palpate/report/table.h"

/// What a work-precision comparison says, read from compare.csv (columns: compare_columns()).
namespace palpate::report {

/// Columns of compare.csv and exchange.csv, in order.
const std::vector<std::string>& compare_columns();
const std::vector<std::string>& exchange_columns();

/// The reference's own error (reference.json): two families' difference.  NaN where not measured.
struct ReferenceError {
  double position_error_rel_l2 = std::numeric_limits<double>::quiet_NaN();
  double force_error_rms_n = std::numeric_limits<double>::quiet_NaN();
  double torque_error_rms_n_m = std::numeric_limits<double>::quiet_NaN();
  std::string description;
};

/// Least-squares slope of log(error) against log(setting) of one integrator.
struct FittedOrder {
  std::string integrator, setting_name;
  double order = std::numeric_limits<double>::quiet_NaN();  ///< NaN with fewer than two usable points
  int points = 0;                                           ///< that were used: status ok, finite, not below the reference
};
std::vector<FittedOrder> fitted_orders(const Table& compare, const std::string& error_column);

/// The cheapest point of all whose error is at most `target`.
struct Cheapest {
  double target = 0.0;
  bool found = false;
  std::string integrator, setting_name;
  double setting = 0.0, error = 0.0, cpu_s = 0.0;
};
std::vector<Cheapest> cheapest(const Table& compare, const std::string& error_column, const std::vector<double>& targets);

/// Error against CPU seconds, log-log, one line per integrator, each point labelled with its tolerance or step.
Plot work_precision_plot(const Table& compare, const std::string& error_column, const std::string& error_label, double reference_error);

/// Error against the exchange period, log-log, with the fitted slope drawn beside it.
Plot exchange_plot(const Table& exchange, const std::string& error_column, const std::string& error_label);

/// "rtol 1e-04", "step 2 ms": a ladder point's setting for people.
std::string setting_text(const std::string& setting_name, double setting);

}  // namespace palpate::report
