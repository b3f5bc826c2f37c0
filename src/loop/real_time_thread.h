#pragma once
#include <sched.h>

#include <atomic>
#include <cstdint>
#include <functional>

#include "palpate/loop/real_time.h"

namespace palpate::loop {

/// Returns the nanoseconds since boot, including time in suspension.
std::int64_t now_ns();
/// Sleeps until that clock reaches `due` [ns]; returns at once if it already has.
void sleep_until_ns(std::int64_t due);

/// Waits until `pause` is false or `ended` returns true. Returns the time waited [ns].
std::int64_t wait_for_the_end_of_a_pause(const std::atomic<bool>& pause, const std::function<bool()>& ended);

/// Prepares the calling thread for a servo loop, as far as the system permits: SCHED_FIFO, pinned to the last
/// processor that this process may use (the first serves most interrupts), memory locked, stack touched.
/// `out` reports the outcome, with reasons for failures.
void claim_real_time(RealTimeResult& out);
/// Unlocks the memory of the process.
void release_memory();

/// Prepares the calling thread as claim_real_time(), and the threads that its loops share with it by
/// SCHED_FIFO of a lower priority, until its end: then scheduling and processors of the threads are as
/// before, and memory is unlocked.
class RealTimeClaim {
 public:
  /// @param threads  number of threads of the loops, including the calling one
  RealTimeClaim(RealTimeResult& out, int threads);
  ~RealTimeClaim();
  RealTimeClaim(const RealTimeClaim&) = delete;
  RealTimeClaim& operator=(const RealTimeClaim&) = delete;

 private:
  int threads_;
  cpu_set_t processors_{};
  sched_param parameters_{};
  int policy_ = 0;
};

}  // namespace palpate::loop
