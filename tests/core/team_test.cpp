#include <gtest/gtest.h>

#include <atomic>
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
