#pragma once
#include "report/plot.h"
#include "report/table.h"

namespace palpate::report {

/// Plots trace.csv: step size over time, logarithmic; rejected attempts as points, coloured by reason.
Plot step_plot(const Table& trace);

}  // namespace palpate::report
