#pragma once
#include "palpate/loop/observer.h"
#include "palpate/loop/run_options.h"
#include "palpate/loop/run_result.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

/// Runs a scene in virtual time or in real time. In virtual time one exchange period follows the other, with
/// interleaved ticks (docs/design.md, 1); if monolithic, one contact refresh follows the other, and ticks are
/// read from dense output. A scene without a tool has periods but no ticks. In real time the ticks follow the
/// wall clock in a separate thread, and the bodies follow one period later. The number of threads is the
/// World's (integrator.threads), whatever other Worlds use.
/// @throws Error as check_clock(), and in real time if an awaited device does not appear
RunResult run(World& world, const RunOptions& options);

}  // namespace palpate::loop
