#include "core/counters.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

using namespace palpate;

TEST(Counters, CountFromManyThreadsWithoutLosingOne) {
  constexpr int kThreads = 4, kEach = 10000;
  counters::reset();
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < kThreads; ++t)
      threads.emplace_back([t] {
        for (int i = 0; i < kEach; ++i) {
          counters::count("test.shared");
          counters::count("test.own" + std::to_string(t) + "." + std::to_string(i % 7));
        }
      });
  }
  EXPECT_EQ(counters::counter("test.shared"), kThreads * kEach);
  EXPECT_EQ(counters::snapshot().at("test.own2.6"), kEach / 7);
}

TEST(Counters, ReferencesSurviveLaterNamesAndReset) {
  auto& early = counters::counter("test.early");
  for (int i = 0; i < 1000; ++i) counters::count("test.later" + std::to_string(i));
  early += 3;
  EXPECT_EQ(counters::counter("test.early"), 3);
  EXPECT_EQ(&early, &counters::counter("test.early"));
  counters::reset();
  EXPECT_EQ(early, 0);
  EXPECT_EQ(counters::snapshot().count("test.early"), 1u);
}
