#include "core/markup.h"

#include <gtest/gtest.h>

using namespace palpate;

namespace {

/// The examples of RFC 4648, section 10.
TEST(Markup, Base64) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(Markup, EscapesWhatXmlDoesNotAllow) {
  EXPECT_EQ(escape_markup("a<b>&\"c'\n"), "a&lt;b&gt;&amp;&quot;c&#39;\n");
  EXPECT_EQ(escape_markup("a\x01z"), "a\xEF\xBF\xBDz");
  EXPECT_EQ(escape_markup("caf\xc3\xa9"), "caf\xc3\xa9");
}

}  // namespace
