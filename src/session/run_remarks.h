#pragma once
#include <string>
#include <vector>

#include "core/missing_outputs.h"
#include "palpate/loop/run.h"

namespace palpate::session {

/// Returns remarks on a run, one line per remark: limits of its result, and events during the run. They are
/// kept in summary.json, and shown by the command line and at the head of the page.
std::vector<std::string> run_remarks(const loop::World& world, const loop::RunResult& result);

/// Returns the remark on the energy at the port of a device. Reductions of the passivity controller either
/// keep energy from the hand, or spare it work: where the removed part of a force would have resisted the
/// motion.
std::string port_remark(const loop::PortEnergy& port);

/// Adds a missing output for each hand whose device had no pose for most ticks of a run to its end.
void check_poses_arrived(const loop::World& world, const loop::RunResult& result, MissingOutputs& missing);

}  // namespace palpate::session
