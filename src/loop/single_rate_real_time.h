#pragma once
#include "body_loop.h"

namespace palpate::loop {

/// Runs a single-rate scene to the end by the wall clock, in the calling thread.  @throws Error as
/// check_clock()
void run_single_rate_in_real_time(World& world, BodyLoop& bodies, const RunOptions& options,
                                  RunResult& result);

}  // namespace palpate::loop
