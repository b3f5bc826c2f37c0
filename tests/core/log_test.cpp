// Warnings are kept, each once, whether or not they are printed.
#include "palpate/core/log.h"

#include <gtest/gtest.h>

using namespace palpate;

TEST(Log, KeepsEveryWarningOnce) {
  for (const bool quiet : {false, true}) {
    log::configure(quiet, false);
    EXPECT_TRUE(log::warnings().empty()) << "those of before are gone";
    log::info("running");
    log::warn("penetration reached {} mm", 11);
    log::warn("too fast");
    log::warn("penetration reached {} mm", 11);
    EXPECT_EQ(log::warnings(), (std::vector<std::string>{"penetration reached 11 mm", "too fast"}));
  }
  log::forget_warnings();
  EXPECT_TRUE(log::warnings().empty());
  log::warn("too fast");
  EXPECT_EQ(log::warnings(), (std::vector<std::string>{"too fast"}));
}

TEST(Log, KeepsABoundedNumberOfTexts) {
  log::configure(true, false);
  for (int i = 0; i < 1005; ++i) log::warn("warning {}", i);
  log::warn("warning {}", 999);  // known
  std::vector<std::string> kept = log::warnings();
  ASSERT_EQ(kept.size(), 1001u);
  EXPECT_EQ(kept[999], "warning 999");
  EXPECT_EQ(kept[1000], "5 more warnings, whose texts were not kept");
  log::forget_warnings();
  log::warn("warning {}", 1004);
  EXPECT_EQ(log::warnings(), (std::vector<std::string>{"warning 1004"}));
}
