#pragma once
#include "session/options.h"
#include "session/run_output.h"

/// Standard output of `palpate run`, `resume` and `movie`.
namespace palpate::cli {

/// Prints the cost of a run, the largest force and torque on each hand, the lateness of ticks in real time,
/// the remarks, and the cost of checkpoints.
void print_outcome(const loop::World& world, const session::RunOutput& ran, const session::Options& options);

/// Prints the error of the wrench on each hand against the references that were computed.
void print_against_references(const loop::World& world, const session::RunOutput& ran);

/// Prints the names of the files, and why states or all files were not written.
void print_files(const loop::World& world, const session::RunOutput& ran);

/// Prints where the frames of a run are, and how to make a movie of them.
void print_frames(const session::DrawnFrames& frames);

/// Prints on standard error what Ctrl-C ended early.  @return whether it ended anything
bool print_stop(const session::RunOutput& ran);

}  // namespace palpate::cli
