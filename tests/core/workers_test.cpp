#include "palpate/core/workers.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <set>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "palpate/core/error.h"

using namespace palpate;

namespace {

/// Checks that every task ran once, by an existing worker.
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

TEST(Workers, ACountHoldsForItsOwnThreadAlone) {
  workers::set_count(2);
  {
    const workers::Count three(3);
    EXPECT_EQ(workers::count(), 3);
    std::thread([] { EXPECT_EQ(workers::count(), 2); }).join();
    const workers::Count one(1);
    EXPECT_EQ(workers::count(), 1);
    std::set<int> seen;
    workers::for_each(50, [&](int, int worker) { seen.insert(worker); });
    EXPECT_EQ(seen, std::set<int>{0});
  }
  EXPECT_EQ(workers::count(), 2);
  EXPECT_THROW(workers::Count(0), Error);
  EXPECT_EQ(workers::count(), 2);
  workers::set_count(1);
}

// After a loop with seven threads, a loop with two uses two.
TEST(Workers, ALoopTakesNoMoreThreadsThanItMay) {
  for (const int threads : {7, 2}) {
    const workers::Count count(threads);
    std::atomic<int> strangers{0}, others{0};
    for (int repeat = 0; repeat < 200; ++repeat)
      workers::for_each(60, [&](int, int worker) {
        if (worker >= threads) ++strangers;
        if (workers::count() != threads) ++others;
      });
    EXPECT_EQ(strangers, 0);
    EXPECT_EQ(others, 0) << "inside a task the count is its loop's";
  }
}

TEST(Workers, CountsTheTasksOfEachThread) {
  const workers::Count two(2);
  const long before = workers::tasks_of(0) + workers::tasks_of(1);
  workers::for_each(40, [](int, int) {});
  EXPECT_EQ(workers::tasks_of(0) + workers::tasks_of(1), before + 40);
}

/// Exit code of a forked child that uses the pool: 0 if loops work there.
int pool_in_child() {
  const pid_t child = fork();
  if (child == 0) {
    alarm(60);
    std::atomic<int> sum{0};
    workers::for_each(100, [&](int task, int) { sum += task; });
    std::exit(sum == 4950 ? 0 : 1);  // runs static destructors as well
  }
  int status = -1;
  waitpid(child, &status, 0);
  return status;
}

// Two threads, so that the order is determined: the first thread goes up, the second one down, until they
// meet.
TEST(Workers, TakesTasksFromBothEnds) {
  const workers::Count two(2);
  for (int repeat = 0; repeat < 200; ++repeat) {
    std::array<int, 40> worker_of{}, place_of{};
    std::array<int, 2> ran{};
    workers::for_each(
        40,
        [&](int task, int worker) {
          worker_of[static_cast<std::size_t>(task)] = worker;
          place_of[static_cast<std::size_t>(task)] = ran[static_cast<std::size_t>(worker)]++;
        },
        workers::Order::kFromBothEnds);
    ASSERT_EQ(ran[0] + ran[1], 40);
    for (int task = 0; task < 40; ++task) {
      ASSERT_EQ(worker_of[static_cast<std::size_t>(task)], task < ran[0] ? 0 : 1);
      ASSERT_EQ(place_of[static_cast<std::size_t>(task)], task < ran[0] ? task : 39 - task);
    }
  }
}

TEST(Workers, ThrowsTheExceptionOfTheFirstTaskThatThrew) {
  for (const int threads : {1, 2, 3}) {
    const workers::Count count(threads);
    for (int repeat = 0; repeat < 100; ++repeat) {
      std::atomic<int> ran{0};
      std::string message;
      try {
        workers::for_each(30, [&](int task, int) {
          ++ran;
          if (task % 7 == 3) fail("task {}", task);
        });
      } catch (const Error& e) { message = e.what(); }
      ASSERT_EQ(message, "task 3");
      ASSERT_EQ(ran, threads == 1 ? 4 : 30);
    }
    expect_every_task_once(50);  // the pool is as before
  }
}

TEST(Workers, RejectsMoreTasksThanALoopHas) {
  const workers::Count two(2);
  EXPECT_THROW(workers::for_each(1 << 16, [](int, int) {}), InternalError);
  std::atomic<int> ran{0};
  workers::for_each((1 << 16) - 1, [&](int, int) { ++ran; });
  EXPECT_EQ(ran, (1 << 16) - 1);
}

TEST(Workers, AForkedChildHasAPoolOfItsOwn) {
  const workers::Count three(3);
  workers::for_each(100, [](int, int) {});
  EXPECT_EQ(pool_in_child(), 0);
}

TEST(Workers, RefusesAnImpossibleNumber) {
  for (int count : {0, -1, 257}) EXPECT_THROW(workers::set_count(count), Error);
  EXPECT_EQ(workers::count(), 1);
}
