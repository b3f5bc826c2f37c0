#pragma once
#if !defined(__x86_64__)
#include <thread>
#endif

namespace palpate {

/// Number of polls of a waiting thread before it sleeps, some 50 us on a 3 GHz core: longer than most serial
/// work between two loops, far shorter than a time slice.
constexpr int kSpins = 4000;

inline void spin_once() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#else
  std::this_thread::yield();
#endif
}

}  // namespace palpate
