#pragma once
#include <sched.h>

namespace palpate::workers {

/// Sets the scheduling of the threads that share the caller's loops, as far as the system permits.  Blocks
/// while another thread runs a shared loop.
/// @param threads  number of threads of the loops, including the calling one, whose scheduling stays
void schedule_helpers(int threads, int policy, const sched_param& parameters);

}  // namespace palpate::workers
