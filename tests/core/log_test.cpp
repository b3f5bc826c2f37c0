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
