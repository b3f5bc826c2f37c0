#pragma once
#include "session/options.h"
#include "session/resumption.h"

namespace palpate::cli {

class MissingOutputs;

/// Loads a scene, runs it, and keeps what it records.
/// @param missing  receives outputs that the run could not deliver; the caller reports and closes it
/// @return the exit status  @throws Error for invalid input, and for a run that failed
int run(const session::Options& options, MissingOutputs& missing);

/// Resumes a run of that scene to its end, as run().
int resume_run(session::Resumption& resumption, const scene::Description& description,
               MissingOutputs& missing);

}  // namespace palpate::cli
