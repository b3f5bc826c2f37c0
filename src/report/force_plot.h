#pragma once
#include "report/plot.h"
#include "report/table.h"

namespace palpate::report {

/// Device force over time from force.csv: three components and the magnitude; a dashed line at the device's
/// limit where `limit_n` > 0.
Plot force_plot(const Table& force, double limit_n);

/// Device torque over time, likewise.
Plot torque_plot(const Table& force, double limit_n_m);

}  // namespace palpate::report
