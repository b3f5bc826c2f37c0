#include "core/clock.h"

#include <gtest/gtest.h>
#include <sys/time.h>

#include <thread>

namespace palpate {
namespace {

void spin(double s) {
  const double start = thread_cpu_seconds();
  while (thread_cpu_seconds() - start < s) {}
}

// By the process's CPU clock most of these runs take 0 s, and some a whole clock tick. The thread's clock is
// not read in between, because that would update the process's clock.
TEST(CpuTime, IsExactWhileATimerCountsIt) {
  const itimerval far{{0, 0}, {100000, 0}}, off{};
  ASSERT_EQ(setitimer(ITIMER_PROF, &far, nullptr), 0);
  int runs = 0;
  for (; runs < 20; ++runs) {
    const double outside = thread_cpu_seconds(), start = cpu_seconds(), until = wall_seconds() + 1e-3;
    while (wall_seconds() < until) {}
    const double found = cpu_seconds() - start, most = thread_cpu_seconds() - outside;
    EXPECT_GE(found, 0.5 * most);
    EXPECT_LE(found, most);
  }
  setitimer(ITIMER_PROF, &off, nullptr);
  EXPECT_EQ(runs, 20);
}

TEST(CpuTime, IsThatOfAllThreads) {
  const double start = cpu_seconds();
  double found = 0.0;
  std::thread other([&] {
    spin(5e-3);
    found = cpu_seconds() - start;  // while both threads are alive
  });
  other.join();
  EXPECT_GE(found, 5e-3);
}

}  // namespace
}  // namespace palpate
