#include "loop/describe_fallbacks.h"

#include <gtest/gtest.h>

namespace palpate::loop {
namespace {

TEST(DescribeFallbacks, OfAMethodThatDidOnlyWhatItWasAskedForAreEmpty) {
  dynamics::StepperCounters counters;
  counters.steps = 100;
  counters.newton_iterations = 130;
  EXPECT_EQ(describe_fallbacks(counters), "");
}

TEST(DescribeFallbacks, AreNamedWithTheirCounts) {
  dynamics::StepperCounters counters;
  counters.halved_steps = 3;
  counters.step_parts = 12;
  counters.most_halvings = 2;
  counters.leaps = 5;
  counters.clamped = 7;
  EXPECT_EQ(describe_fallbacks(counters),
            "3 steps divided into 12 parts, the smallest 1/4 of a step, 5 solves repeated with undamped "
            "Newton corrections, 7 clamped element tangents");
}

}  // namespace
}  // namespace palpate::loop
