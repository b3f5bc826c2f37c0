#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "palpate/loop/run.h"

namespace palpate::loop {

/// Times of the checkpoints of a run, and functions that store and resume them.
struct CheckpointPlan {
  /// Simulated time between two checkpoints [s]; each is made at the end of the first period at or after its
  /// time.
  double every_s = 0.0;
  /// Assembles the scene's World as at the start of run().
  std::function<std::unique_ptr<World>()> assemble;
  /// Stores a checkpoint; data recorded by then must be on disk before.
  std::function<void(double time_s, const Archive& checkpoint)> keep;
};

/// Cost of the checkpoints of a run.
struct CheckpointCost {
  long written = 0;
  double keep_s = 0.0;      ///< Wall time to archive and store them [s].
  double assemble_s = 0.0;  ///< Wall time to assemble Worlds again [s].
  void archive(Archive& a);
};

/// Returns a hash of the assembled bodies: meshes, skins, initial positions, masses and element materials,
/// and of the device files. Files that a scene refers to may change while its text does not.
std::string fingerprint(const World& world);

/// Returns the reason why a run of this scene cannot have checkpoints; empty: it can.
std::string why_no_checkpoints(const World& world, const RunOptions& options);

/// Checks the interval of checkpoints.
/// @throws Error if `every_s` is shorter than a period, or not shorter than the run
void check_checkpoints(const scene::Description& description, double every_s, double duration_s);

/// Checkpoint from which a run resumes.
struct Resumed {
  Archive archive;
  /// Counters of the assembly of the resumed World (core/counters.h). The process continues from the
  /// counters of the interrupted one, so that the summaries agree; OpenGL is counted once per process.
  std::map<std::string, long> counted = {};
};

/// Runs in virtual time with checkpoints. At each checkpoint the World is destroyed, assembled again and
/// continued from the archive alone, exactly as in a run that is resumed from it: both are bitwise identical.
/// Integrator, factors, initial guesses and contact restart there, so that no state can be missed by the
/// archive.
/// @param world   assembled; on return the last World
/// @param cost    total over all checkpoints, including those before `from`
/// @param from    checkpoint from which observers, too, restore their archived state; null at the start
RunResult run_with_checkpoints(std::unique_ptr<World>& world, const RunOptions& options,
                               const CheckpointPlan& plan, CheckpointCost& cost, Resumed* from = nullptr);

}  // namespace palpate::loop
