#pragma once
#include "report/plot.h"
#include "report/table.h"

namespace palpate::report {

/// Plots the device force over time from force.csv: three components and the magnitude, with a dashed line at
/// the limit of the device if `limit_n` > 0.
Plot force_plot(const Table& force, double limit_n);

/// Plots the device torque over time from force.csv: three components and the magnitude, with a dashed line
/// at the limit of the device if `limit_n_m` > 0.
Plot torque_plot(const Table& force, double limit_n_m);

}  // namespace palpate::report
