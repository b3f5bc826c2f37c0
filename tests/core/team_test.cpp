#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "core/team.h"
#include "palpate/core/error.h"

namespace palpate {
namespace {

TEST(Team, WorksTogetherAgainAndAgain) {
  for (const int size : {1, 2, 4}) {
    Team team(size);
    std::vector<long> slots(static_cast<std::size_t>(size), 0), sums(static_cast<std::size_t>(size), 0);
    for (long round = 1; round <= 200; ++round)
      team.run([&](int k) {
        slots[static_cast<std::size_t>(k)] = round * (k + 1);
        team.barrier();
        // Each thread must see the slots of all threads.
        for (const long slot : slots) sums[static_cast<std::size_t>(k)] += slot;
        team.barrier();
      });
    for (const long sum : sums) EXPECT_EQ(sum, 200 * 201 / 2 * size * (size + 1) / 2);
  }
  EXPECT_THROW(Team(0), InternalError);
}

TEST(Team, IsOfOneInAScopeAlone) {
  const workers::Count count(2);
  Team team(2);
  long slots = 0;
  const auto add = [&](int k) {
    slots += 1 + k;
    team.barrier();
  };
  {
    const workers::Alone alone;
    EXPECT_EQ(team.size(), 1);
    EXPECT_EQ(team.most(), 2);
    EXPECT_EQ(workers::count(), 1);
    team.run(add);
    EXPECT_EQ(slots, 1);
  }
  EXPECT_EQ(team.size(), 2);
  EXPECT_EQ(workers::count(), 2);
}

// A helper that is far behind is noticed by the thread that waits for it.
TEST(Team, CountsWaitsBeyondSpinning) {
  Team team(2);
  const auto behind = [&](int k) {
    if (k == 1) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    team.barrier();
  };
  long before = workers::long_waits();
  team.run(behind);
  const long in_barrier = workers::long_waits() - before;
  EXPECT_GE(in_barrier, 1);
  before = workers::long_waits();
  workers::run_together(
      2,
      [](void*, int k, int) {
        if (k == 1) std::this_thread::sleep_for(std::chrono::milliseconds(20));
      },
      nullptr);
  EXPECT_LE(workers::long_waits() - before, 1);
}

// Two callers that also run loops: one pool serves all of them, one after the other.
TEST(Team, TeamsOfSeveralThreadsShareThePool) {
  const auto work = [](int size, long& total) {
    const workers::Count count(size);
    Team team(size);
    std::atomic<long> sum{0};
    for (int round = 0; round < 200; ++round) {
      team.run([&](int k) {
        sum += k + 1;
        team.barrier();
      });
      workers::for_each(size, [&](int, int) { ++sum; });
    }
    total = sum;
  };
  long of_two = 0, of_four = 0;
  std::thread other([&] { work(2, of_two); });
  work(4, of_four);
  other.join();
  EXPECT_EQ(of_two, 200 * (3 + 2));
  EXPECT_EQ(of_four, 200 * (10 + 4));
}

}  // namespace
}  // namespace palpate
