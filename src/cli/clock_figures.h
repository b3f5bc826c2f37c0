#pragma once
#include <string>

#include "palpate/loop/run.h"

namespace palpate::cli {

/// Says how late the ticks of a run in real time were, what they cost, and what the bodies left out.
/// @pre the run was in real time
/// @param linearisation  of the exchange, by its name in the scene
void print_clock(const loop::RunResult& result, const std::string& linearisation);
/// clock.csv: lateness and work of each tick [us].
void keep_clock(const loop::RealTimeResult& clock, const std::string& folder);

}  // namespace palpate::cli
