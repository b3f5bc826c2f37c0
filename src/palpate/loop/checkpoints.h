#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "palpate/loop/run.h"

namespace palpate::loop {

/// When a run keeps where it is, and what it goes on with.
struct CheckpointPlan {
  /// simulated time between two [s]; each is at the end of the first period at or after its time
  double every_s = 0.0;
  /// The scene's World as run() would begin with it.
  std::function<std::unique_ptr<World>()> assemble;
  /// Keeps it: what was recorded by then must be safe before it is.
  std::function<void(double time_s, const Archive& checkpoint)> keep;
};

/// What checkpoints cost a run.
struct CheckpointCost {
  long written = 0;
  double keep_s = 0.0;      ///< wall time to archive and keep them [s]
  double assemble_s = 0.0;  ///< wall time to assemble Worlds anew [s]
  void archive(Archive& a);
};

/// Names the bodies of a World as assembled: meshes, where they begin, materials of elements.  Files that a
/// scene names may change while its text does not.
std::string fingerprint(const World& world);

/// Why a run of this scene has no checkpoints; empty: it can have them.
std::string why_no_checkpoints(const World& world, const RunOptions& options);

/// @throws Error where a run of that scene would have no checkpoint, or more than it can: `every_s` is
/// shorter
///   than a period, or as long as the run
void check_checkpoints(const scene::Description& description, double every_s, double duration_s);

/// Where a run goes on.
struct Resumed {
  Archive archive;
  /// What the assembly of the World that goes on counted (core/counters.h).  The process then counts on from
  /// where the one that stopped was, so that a summary says the same; what GL opens is opened once a process.
  std::map<std::string, long> counted = {};
};

/// run() in virtual time with checkpoints.  At each one the World is given up and assembled anew, and goes on
/// from what was kept alone: so does a run that is resumed from it, and both are the same to the last bit.
/// Integrator, factors, initial guesses and contact begin anew there, and nothing of them can be forgotten.
/// @param world   assembled; at the end the last one
/// @param cost    of all checkpoints, those before `from` included
/// @param from    where the run goes on, null at its start; observers get from it what they archived
RunResult run_with_checkpoints(std::unique_ptr<World>& world, const RunOptions& options,
                               const CheckpointPlan& plan, CheckpointCost& cost, Resumed* from = nullptr);

}  // namespace palpate::loop
