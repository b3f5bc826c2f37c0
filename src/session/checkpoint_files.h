#pragma once
#include <string>

#include "loop/checkpoints.h"
#include "session/options.h"

namespace palpate::session {

/// Returns the path of the last complete checkpoint in the folder of a run.
std::string checkpoint_path(const std::string& folder);

/// Removes the checkpoint and the journals of an earlier run, which would pass for files of this run.
void remove_checkpoint(const std::string& folder);

/// Rejects at the start the options of a run whose state checkpoints cannot keep.
/// @throws Error with the reason
void check_checkpoints(const Options& options, const scene::Description& description);

/// Identity of a run, kept in its checkpoints together with the state of the loop.
struct RunIdentity {
  Options options;         ///< Options as given; those that exclude checkpoints are not archived
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
RunIdentity identity_of(const Options& options, const loop::World& world);

/// Returns the instruction sets in use, as "avx512, OpenBLAS SKYLAKEX".
std::string instructions_in_use();

/// Returns the plan of when and how to write checkpoints of a run of that scene; each checkpoint replaces the
/// one before.
loop::CheckpointPlan checkpoint_plan(RunIdentity identity, const scene::Description& description,
                                     const std::string& folder);

}  // namespace palpate::session
