#pragma once
#include "report/plot.h"
#include "report/table.h"

namespace palpate::report {

/// Plot of trace.csv: step size over time, logarithmic; rejected attempts as points, coloured by their
/// reason.
Plot step_plot(const Table& trace);

}  // namespace palpate::report
