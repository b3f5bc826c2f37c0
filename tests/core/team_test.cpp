#include <gtest/gtest.h>

#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/team.h"

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
        for (const long slot : slots) sums[static_cast<std::size_t>(k)] += slot;  // sees what all wrote
        team.barrier();
      });
    for (const long sum : sums) EXPECT_EQ(sum, 200 * 201 / 2 * size * (size + 1) / 2);
  }
  EXPECT_THROW(Team(0), InternalError);
}

}  // namespace
}  // namespace palpate
