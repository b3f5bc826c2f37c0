#pragma once
#include <string>
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::cli {

/// Returns remarks on a run, one line per remark: limits of its result, and events during the run. They are
/// printed to standard output and kept in summary.json, from which the head of the page shows them.
std::vector<std::string> run_remarks(const loop::World& world, const loop::RunResult& result);

}  // namespace palpate::cli
