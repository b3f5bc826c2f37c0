#include "palpate/core/error.h"

#include <gtest/gtest.h>

using namespace palpate;

namespace {
std::string message_of(auto&& call) {
  try {
    call();
  } catch (const std::exception& e) { return e.what(); }
  return "nothing was thrown";
}
}  // namespace

TEST(Error, NearestNameForgivesTyposOnly) {
  const std::vector<std::string> names = {"cvode-bdf", "linearly-implicit-euler", "verlet"};
  EXPECT_EQ(nearest_name("cvode-bfd", names), "cvode-bdf");
  EXPECT_EQ(nearest_name("linearly_implicit_euler", names), "linearly-implicit-euler");
  EXPECT_EQ(nearest_name("verle", names), "verlet");
  EXPECT_EQ(nearest_name("cvode", names), "cvode-bdf");
  EXPECT_EQ(nearest_name("pumpkin", names), "");
  EXPECT_EQ(nearest_name("x", {}), "");
}

// A candidate is not nearer for being a prefix of the word, or for having the word as its prefix.
TEST(Error, NearestNameIsTheOneOfLeastDistance) {
  EXPECT_EQ(nearest_name("blok", {"b", "block"}), "block");
  EXPECT_EQ(nearest_name("ballon", {"ball", "balloon"}), "balloon");
  EXPECT_EQ(nearest_name("bal", {"ballroom", "ball"}), "ball");
  EXPECT_EQ(nearest_name("blal", {"bowl", "ball"}), "ball") << "two letters changed places: one slip";
  EXPECT_EQ(nearest_name("FLOOR", {"flour", "floor"}), "floor") << "case is no slip";
  EXPECT_EQ(nearest_name("stiffness", {"stiffening", "stiffness_pa_m"}), "stiffness_pa_m") << "a unit";
  EXPECT_EQ(nearest_name("lin", {"verlet", "linearly-implicit-euler"}), "linearly-implicit-euler");
}

TEST(Error, SuggestionNamesTheNearestOrListsAll) {
  EXPECT_EQ(suggestion("bal", {"box", "ball"}), " (did you mean \"ball\"?)");
  EXPECT_EQ(suggestion("pumpkin", {"box", "ball"}), " (known: box, ball)");
  EXPECT_EQ(suggestion("pumpkin", {}), "");
}

TEST(Error, FailFormatsAndIsCatchableAsError) {
  EXPECT_THROW(fail("{}: {}", "a", 1), Error);
  EXPECT_EQ(message_of([] { fail("mass_kg = {} must be positive", -0.5); }),
            "mass_kg = -0.5 must be positive");
}

TEST(Error, CheckNamesPlaceConditionAndValues) {
  const int n = 3;
  EXPECT_NO_THROW(PALPATE_CHECK(n == 3, "n = {}", n));
  EXPECT_THROW(PALPATE_CHECK(n == 4, "n = {}", n), InternalError);
  const std::string message = message_of([] {
    const int m = 5;
    PALPATE_CHECK(m == 4, "m = {}", m);
  });
  EXPECT_NE(message.find("error_test.cpp:"), std::string::npos) << message;
  EXPECT_NE(message.find("`m == 4`: m = 5"), std::string::npos) << message;
}
