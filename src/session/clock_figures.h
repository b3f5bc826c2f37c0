#pragma once
#include <string>
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::session {

/// Returns remarks on rates and on skipped work of the bodies, one line per remark (run_remarks.h).
/// @pre the run was in real time
/// @param linearisation  linearisation of the exchange, by its name in the scene
std::vector<std::string> clock_remarks(const loop::RunResult& result, const std::string& linearisation);
/// Writes clock.csv: lateness and work of each tick [us].
void write_clock(const loop::RealTimeResult& clock, const std::string& folder);

}  // namespace palpate::session
