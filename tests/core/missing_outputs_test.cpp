#include "core/missing_outputs.h"

#include <gtest/gtest.h>

using namespace palpate;

TEST(MissingOutputs, NameTheOutputAndTheFirstLineOfTheReason) {
  MissingOutputs missing;
  EXPECT_TRUE(missing.empty());
  missing.add("picture out/picture.png", "no context\nEGL 1.5");
  MissingOutputs more;
  more.add("movie a.webm", "the disk is full");
  missing.add(more);
  EXPECT_EQ(missing.outputs(), (std::vector<std::string>{"picture out/picture.png (no context)",
                                                         "movie a.webm (the disk is full)"}));
}
