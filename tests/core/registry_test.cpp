#include "palpate/core/registry.h"

#include <gtest/gtest.h>

using namespace palpate;

namespace {
using Make = int (*)();
const Registry<Make> kRegistry = {{"box", "a box", 0, [] { return 6; }},
                                  {"ball", "a ball", 2, [] { return 1; }}};
}  // namespace

TEST(Registry, FindsByExactName) {
  EXPECT_EQ(find(kRegistry, "ball", "generator").make(), 1);
  EXPECT_EQ(find(kRegistry, "ball", "generator").order, 2);
  EXPECT_EQ(names(kRegistry), (std::vector<std::string>{"box", "ball"}));
}

TEST(Registry, UnknownNameIsRefusedWithTheNearest) {
  try {
    find(kRegistry, "bal", "generator");
    FAIL() << "accepted";
  } catch (const Error& e) { EXPECT_STREQ(e.what(), "unknown generator \"bal\" (did you mean \"ball\"?)"); }
}
