#pragma once
#include <atomic>
#include <cstdint>
#include <type_traits>

#include "palpate/core/workers.h"

namespace palpate {

/// Team of threads that repeatedly work together on one computation: the caller and size() - 1 threads of the
/// process's pool (workers.h).  A waiting thread spins for some tens of microseconds and then sleeps: on a
/// machine with fewer free cores than threads a spinning team costs seconds.  One caller at a time.  Work
/// must not throw: an exception in a worker ends the program.
class Team {
 public:
  /// @param size  number of threads, including the caller; at least 1
  explicit Team(int size);
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;
  int size() const { return size_; }

  /// Calls work(k) for k = 0 ... size() - 1, one thread each, including the caller; returns when all have
  /// returned.  Allocates nothing once the pool has its threads.
  template <class Work>
  void run(Work&& work) {
    using W = std::remove_reference_t<Work>;
    if (size_ == 1) return static_cast<void>(work(0));
    workers::run_together(
        size_, [](void* w, int k, int) { (*static_cast<W*>(w))(k); },
        const_cast<std::remove_const_t<W>*>(&work));
  }
  /// Waits until every thread has reached the barrier; inside run() only.
  void barrier();

 private:
  int size_;
  std::atomic<std::uint32_t> phase_{0}, arrived_{0};
};

}  // namespace palpate
