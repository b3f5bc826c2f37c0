#pragma once
#include <sched.h>
#include <time.h>

#include <atomic>
#include <cstdint>
#if !defined(__x86_64__)
#include <thread>
#endif

namespace palpate {

/// Longest time that a waiting thread polls before it sleeps [ns]: longer than most serial work between two
/// loops, far shorter than a time slice.
constexpr std::int64_t kSpinNs = 50'000;

inline void spin_once() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#else
  std::this_thread::yield();
#endif
}

inline std::int64_t monotonic_ns() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return std::int64_t{1'000'000'000} * t.tv_sec + t.tv_nsec;
}

/// Polls until done() is true, for at most kSpinNs.  Ends at once where this thread runs on the processor
/// `other`, on which the thread that it waits for was last: polling keeps that one from running.  Returns
/// done().
template <class Done>
bool spin_until(Done&& done, const std::atomic<int>& other) {
  constexpr int kPollsPerLook = 32;
  for (const std::int64_t end = monotonic_ns() + kSpinNs;
       other.load(std::memory_order_relaxed) != sched_getcpu();) {
    for (int poll = 0; poll < kPollsPerLook; ++poll) {
      if (done()) return true;
      spin_once();
    }
    if (monotonic_ns() > end) break;
  }
  return done();
}

}  // namespace palpate
