#pragma once
#include <string>
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::cli {

/// Logs a warning for each [[contact]] whose overlap became too deep for a penalty.
void warn_of_deep_overlaps(const loop::World& world);

/// Lists remarks on a run, a line each: limits of its result, and events on the way.  Standard output prints
/// them, summary.json holds them, and the head of the page shows them from there.
std::vector<std::string> run_remarks(const loop::World& world, const loop::RunResult& result);

}  // namespace palpate::cli
