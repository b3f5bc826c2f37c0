// Search for contact on several threads.
#include "bodies.h"
#include "palpate/core/workers.h"

using namespace distance_tests;

// The copies of the skins that other threads have skip the queries in which these take no part.
TEST(SharedSearch, ResultIsTheSameForAnyNumberOfThreads) {
  Pair pair;
  const SkinContactSpec spec{
      .stiffness_pa_m = 1e6,
      .spacing_m = {0.5 * pair.a.skin.longest_edge.mean(), 0.5 * pair.b.skin.longest_edge.mean()}};
  SkinContact alone(pair.a.skin, pair.b.skin, spec), shared(pair.a.skin, pair.b.skin, spec);
  std::mt19937 random(17);
  std::uniform_real_distribution<double> turn(-0.05, 0.05), shift(-0.004, 0.004);
  const auto expect_equal = [&] {
    ASSERT_EQ(alone.springs().size(), shared.springs().size());
    for (std::size_t i = 0; i < alone.springs().size(); ++i) {
      const Spring &a = alone.springs()[i], &s = shared.springs()[i];
      ASSERT_TRUE(a.side == s.side && a.point == s.point && a.face == s.face && a.weights == s.weights &&
                  a.reach == s.reach && a.gap == s.gap && a.force == s.force && a.stiffness == s.stiffness &&
                  a.energy == s.energy && a.is_placed == s.is_placed)
          << i;
    }
  };
  const long before = workers::tasks_of(1);
  std::size_t springs = 0;
  int queries = 0;
  for (; queries < 40 || (workers::tasks_of(1) == before && queries < 4000); ++queries) {
    pair.b.place(rotation({turn(random), -0.8 + turn(random), turn(random)}),
                 {0.166 + shift(random), 0.01 + shift(random), shift(random)});
    const workers::Count count(1 + queries % 3);
    if (queries % 5 == 0)
      shared.find(pair.a.at(), pair.b.at(), 0.002);
    else
      shared.follow(pair.a.at(), pair.b.at());
    const workers::Count one(1);
    if (queries % 5 == 0)
      alone.find(pair.a.at(), pair.b.at(), 0.002);
    else
      alone.follow(pair.a.at(), pair.b.at());
    expect_equal();
    springs += alone.springs().size();
  }
  EXPECT_GT(springs, 1000u);
  EXPECT_GT(workers::tasks_of(1), before) << "after " << queries << " queries";
}
