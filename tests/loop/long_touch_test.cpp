// Short version of million_ticks_test.cpp, with a block of a few tetrahedra.
#include "loop/long_touch.h"

#include <gtest/gtest.h>

#include "loop/small_scenes.h"

using namespace palpate;

TEST(LongTouch, AToolAtRestOnAFrozenBlockDoesNotDrift) {
  scene::Description d = small_scenes::pressed_block(2e-3);
  long_touch::freeze(d, 0.1);
  const long_touch::Drift drift = long_touch::rest(d, 20'000, 5'000);
  EXPECT_EQ(drift.ticks, 20'000);
  long_touch::expect_no_drift(drift);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers keep freed memory
  EXPECT_LT(drift.memory_mib, 1.0) << "15,000 ticks of one record each would be 7 MiB";
#endif
}
