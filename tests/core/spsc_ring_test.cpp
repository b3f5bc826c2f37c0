#include "core/spsc_ring.h"

#include <gtest/gtest.h>

#include <thread>

using namespace palpate;

TEST(SpscRing, GivesEachValueOnceAndInOrder) {
  SpscRing<long> ring(64);
  constexpr long kCount = 200'000;
  std::thread writer([&] {
    for (long i = 0; i < kCount;) i += ring.push(i);
  });
  long expected = 0;
  for (long value; expected < kCount;) {
    if (!ring.pop(value)) continue;
    ASSERT_EQ(value, expected);
    ++expected;
  }
  writer.join();
  long left = 0;
  EXPECT_FALSE(ring.pop(left));
}

TEST(SpscRing, RefusesWhatDoesNotFit) {
  SpscRing<int> ring(3);
  ASSERT_EQ(ring.capacity(), 4u);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.push(i));
  EXPECT_FALSE(ring.push(4));
  int value = -1;
  EXPECT_TRUE(ring.pop(value));
  EXPECT_EQ(value, 0);
  EXPECT_TRUE(ring.push(5));
  EXPECT_FALSE(ring.push(6));
}
