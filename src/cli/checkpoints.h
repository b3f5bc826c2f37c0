#pragma once
#include <optional>
#include <string>

#include "loop/checkpoints.h"
#include "run.h"
#include "store/checkpoint_file.h"

namespace palpate::cli {

/// Returns the path of the last complete checkpoint in the folder of a run.
std::string checkpoint_path(const std::string& folder);

/// Removes the checkpoint and the journals of an earlier run, which would pass for files of this run.
void remove_checkpoint(const std::string& folder);

/// Rejects at the start the options of a run whose state checkpoints cannot keep.
/// @throws Error with the reason
void check_checkpoints(const RunArguments& arguments, const scene::Description& description);

/// Identity of a run, kept in its checkpoints together with the state of the loop.
struct RunIdentity {
  RunArguments arguments;  ///< Arguments as typed
  std::string scene_path;  ///< Absolute path of the scene
  std::string bodies;      ///< loop::fingerprint() of the World as assembled
  std::string cpu;         ///< CPU of the machine: other CPUs round differently
  /// Instruction sets of the kernels of palpate and of the linear algebra; the environment may select them,
  /// and they too change rounding
  std::string instructions;
  void archive(Archive& a);
};

/// Returns the identity of a run on this machine.
/// @param world  the World as assembled
RunIdentity identity_of(const RunArguments& arguments, const loop::World& world);

/// Returns the instruction sets in use, as "avx512, OpenBLAS SKYLAKEX".
std::string instructions_in_use();

/// Returns the plan of when and how to write checkpoints of a run of that scene; each checkpoint replaces the
/// one before.
loop::CheckpointPlan checkpoint_plan(RunIdentity identity, const scene::Description& description,
                                     const std::string& folder);

/// Prints the number of checkpoints and the time that they took; `every_s` is their interval in simulated
/// time [s].
void print_checkpoints(const loop::CheckpointCost& cost, double every_s);

/// Run to resume from its checkpoint.
struct Resumption {
  std::string folder;
  RunIdentity identity;
  store::Checkpoint checkpoint;
  loop::Resumed from;  ///< State of the loop, decoded from `checkpoint`
};
/// Resumes the run to its end.  @return the exit status
int resume_run(Resumption& resumption, const scene::Description& description, MissingOutputs& missing);

}  // namespace palpate::cli
