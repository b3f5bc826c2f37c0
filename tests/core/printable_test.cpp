// Characters that may be printed to a terminal, and the range of whole numbers that a double represents.
#include "core/printable.h"

#include <gtest/gtest.h>

#include "core/whole_number.h"

namespace palpate {
namespace {

TEST(Printable, ControlCharactersAreEscaped) {
  EXPECT_EQ(printable("a\x1b[31mb\x07\r\x7f"), "a\\x1b[31mb\\x07\\x0d\\x7f");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "\\xc2\\x9b2J")
      << "C1, which terminals take for ESC [";
  EXPECT_EQ(printable(std::string_view("\0", 1)), "\\x00");
  for (const char* harmless : {"", "plain\n\ttext", "caf\xc3\xa9", "\xe9\x9b\xaa", "\xc2\xa0", "\xc2"}) {
    EXPECT_EQ(printable(harmless), harmless);
    EXPECT_TRUE(is_printable(harmless));
  }
  EXPECT_FALSE(is_printable("\x1b"));
}

TEST(WholeNumber, BeyondTwoToThe53) {
  for (const char* text : {"9007199254740993", "-9007199254740993", "+10000000000000000",
                           "00009007199254740993", "99999999999999999999999999"})
    EXPECT_TRUE(beyond_whole(std::string_view(text))) << text;
  for (const char* text : {"9007199254740992", "-9007199254740992", "0", "000000000000000000000", "", "-",
                           "1e30", "90071992547409930.0", "nan", "seven"})
    EXPECT_FALSE(beyond_whole(std::string_view(text))) << text;
  EXPECT_TRUE(beyond_whole(std::numeric_limits<std::int64_t>::min()));
  EXPECT_TRUE(beyond_whole(std::numeric_limits<std::uint64_t>::max()));
  EXPECT_FALSE(beyond_whole(kLargestWhole));
}

}  // namespace
}  // namespace palpate
