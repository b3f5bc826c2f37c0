#include "palpate/core/named_enum.h"

#include <gtest/gtest.h>

#include <array>

namespace {

enum class Fill { kEmpty, kHalf, kSolid };
constexpr std::array<std::string_view, 3> option_names(Fill) { return {"empty", "half", "solid"}; }
enum class Nameless { kOne };

}  // namespace

using namespace palpate;

TEST(NamedEnum, ValuesAndNamesCorrespondBothWays) {
  static_assert(NamedEnum<Fill> && !NamedEnum<Nameless> && !NamedEnum<int>);
  EXPECT_EQ(name_of(Fill::kEmpty), "empty");
  EXPECT_EQ(name_of(Fill::kSolid), "solid");
  for (const Fill value : {Fill::kEmpty, Fill::kHalf, Fill::kSolid})
    EXPECT_EQ(value_named<Fill>(name_of(value)), value);
}

TEST(NamedEnum, OtherNamesHaveNoValue) {
  for (const char* name : {"", "Half", "half ", "hal"}) EXPECT_FALSE(value_named<Fill>(name)) << name;
}

TEST(NamedEnum, ListsAllNamesOrThoseOfSomeValues) {
  EXPECT_EQ(names_of_options<Fill>(), (std::vector<std::string>{"empty", "half", "solid"}));
  EXPECT_EQ(names_of_options<Fill>({Fill::kSolid, Fill::kEmpty}),
            (std::vector<std::string>{"solid", "empty"}));
}
