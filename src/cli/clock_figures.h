#pragma once
#include <string>
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::cli {

/// Prints quantiles of how late the ticks were, of their cost and of the exchanges' latency.
void print_clock(const loop::RealTimeResult& clock);
/// Rates, and what the bodies left out, a line each (run_remarks.h).
/// @pre the run was in real time
/// @param linearisation  of the exchange, by its name in the scene
std::vector<std::string> clock_remarks(const loop::RunResult& result, const std::string& linearisation);
/// clock.csv: lateness and work of each tick [us].
void keep_clock(const loop::RealTimeResult& clock, const std::string& folder);

}  // namespace palpate::cli
