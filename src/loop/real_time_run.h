#pragma once
#include "body_loop.h"

namespace palpate::loop {

/// Opens the devices of all hands and waits for those that need it. Returns false if the run was stopped
/// meanwhile.
bool await_devices(World& world, const RunOptions& options);

/// Runs both sides to the end by the wall clock, the ticks in a thread of their own.  @throws Error as
/// check_clock()
void run_in_real_time(World& world, BodyLoop& bodies, const RunOptions& options, RunResult& result);

}  // namespace palpate::loop
