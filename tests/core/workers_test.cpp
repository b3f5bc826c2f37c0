#include "palpate/core/workers.h"

#include <array>
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "palpate/core/error.h"

using namespace palpate;

namespace {

/// Every task ran once, by a worker that exists.
void expect_every_task_once(int tasks) {
  std::array<std::atomic<int>, 300> runs{};
  std::atomic<int> strangers{0};
  workers::for_each(tasks, [&](int task, int worker) {
    ++runs[static_cast<std::size_t>(task)];
    if (worker < 0 || worker >= workers::count()) ++strangers;
  });
  for (int t = 0; t < 300; ++t)
    ASSERT_EQ(runs[static_cast<std::size_t>(t)], t < tasks ? 1 : 0) << "task " << t << " of " << tasks;
  EXPECT_EQ(strangers, 0);
}

}  // namespace

TEST(Workers, EveryTaskRunsOnceWithAnyNumberOfThreads) {
  EXPECT_EQ(workers::count(), 1);
  for (int threads : {1, 2, 3, 7, 2, 1}) {
    workers::set_count(threads);
    EXPECT_EQ(workers::count(), threads);
    for (int repeat = 0; repeat < 50; ++repeat)
      for (int tasks : {0, 1, 2, 5, 300}) expect_every_task_once(tasks);
  }
}

TEST(Workers, ALoopInsideALoopIsRunByItsCaller) {
  workers::set_count(3);
  std::atomic<int> inner{0}, by_others{0};
  workers::for_each(8, [&](int, int) {
    workers::for_each(5, [&](int, int worker) {
      ++inner;
      if (worker != 0) ++by_others;
    });
  });
  EXPECT_EQ(inner, 40);
  EXPECT_EQ(by_others, 0);
  workers::set_count(1);
}

TEST(Workers, LoopsOfTwoThreadsDoNotMix) {
  workers::set_count(3);
  const auto many = [] {
    for (int repeat = 0; repeat < 200; ++repeat) expect_every_task_once(1 + repeat % 60);
  };
  std::thread other(many);
  many();
  other.join();
  workers::set_count(1);
}

TEST(Workers, RefusesAnImpossibleNumber) {
  for (int count : {0, -1, 257}) EXPECT_THROW(workers::set_count(count), Error);
  EXPECT_EQ(workers::count(), 1);
}
