#pragma once
#include <optional>
#include <string>

#include "commands.h"
#include "loop/checkpoints.h"
#include "store/checkpoint_file.h"
#include "store/summary.h"

namespace palpate::cli {

/// The checkpoint in the folder of a run: the last whole one.
std::string checkpoint_path(const std::string& folder);

/// What a run of an earlier day left there, which would pass for this one's.
void remove_checkpoint(const std::string& folder);

/// Refuses at the start what a run with checkpoints cannot keep.  @throws Error with the reason
void check_checkpoints(const RunArguments& arguments, const scene::Description& description);

/// What a checkpoint knows of its run beside the loop's state.
struct RunIdentity {
  RunArguments arguments;  ///< as they were typed
  std::string scene_path;  ///< absolute
  std::string bodies;      ///< loop::fingerprint() of the World as it was assembled
  std::string cpu;         ///< of the machine: others round differently
  /// of the kernels in use, ours and the linear algebra's, which the environment may choose: likewise
  std::string instructions;
  void archive(Archive& a);
};

/// "avx512, OpenBLAS SKYLAKEX"
std::string instructions_in_use();

/// When to keep a run of that scene, and how: each checkpoint takes the place of the one before.
loop::CheckpointPlan checkpoint_plan(RunIdentity identity, const scene::Description& description,
                                     const std::string& folder);

void print_checkpoints(const loop::CheckpointCost& cost, double every_s);
void add_checkpoints(store::Summary& summary, const loop::CheckpointCost& cost, double every_s);

/// A run that goes on.
struct Resumption {
  std::string folder;
  RunIdentity identity;
  store::Checkpoint checkpoint;
  loop::Resumed from;  ///< what `checkpoint` holds
};
int resume_run(Resumption& resumption, const scene::Description& description, MissingOutputs& missing);

}  // namespace palpate::cli
