#include "palpate/core/clock.h"

#include <gtest/gtest.h>
#include <sys/time.h>

#include <thread>

namespace palpate {
namespace {

void spin(double s) {
  const double start = thread_cpu_seconds();
  while (thread_cpu_seconds() - start < s) {}
}

// With the process's own clock most of these runs take 0 s, some a whole tick.
TEST(CpuTime, IsExactWhileATimerCountsIt) {
  const itimerval far{{0, 0}, {100000, 0}}, off{};
  ASSERT_EQ(setitimer(ITIMER_PROF, &far, nullptr), 0);
  int runs = 0;
  for (; runs < 50; ++runs) {
    const double outside = thread_cpu_seconds(), start = cpu_seconds(), inside = thread_cpu_seconds();
    spin(2e-4);
    const double least = thread_cpu_seconds() - inside, found = cpu_seconds() - start;
    EXPECT_GE(found, least);
    EXPECT_LE(found, thread_cpu_seconds() - outside);
  }
  setitimer(ITIMER_PROF, &off, nullptr);
  EXPECT_EQ(runs, 50);
}

TEST(CpuTime, IsThatOfAllThreads) {
  const double start = cpu_seconds();
  double found = 0.0;
  std::thread other([&] {
    spin(5e-3);
    found = cpu_seconds() - start;  // while both live
  });
  other.join();
  EXPECT_GE(found, 5e-3);
}

}  // namespace
}  // namespace palpate
