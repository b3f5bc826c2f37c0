#pragma once
#include <cstdint>

#include "palpate/loop/real_time.h"

namespace palpate::loop {

/// Nanoseconds since the machine started, those included in which it was suspended.
std::int64_t now_ns();
/// Sleeps until that clock shows that [ns]; returns at once where it does already.
void sleep_until_ns(std::int64_t due);

/// Makes the calling thread what a servo loop wants, as far as the system permits: SCHED_FIFO, pinned to the
/// last processor that this process may use (the first serves most interrupts), pages of the process locked
/// in memory, its stack touched.  What was not permitted stands in `out` with the reason.
void claim_real_time(RealTimeResult& out);
/// Pages may be swapped again.
void release_memory();

}  // namespace palpate::loop
