// Rendering of Markdown as plain text for a terminal.
#include "plain_text.h"

#include <gtest/gtest.h>

#include <sstream>

using palpate::cli::plain_text;
using palpate::cli::title_of;

namespace {

TEST(PlainText, HeadingsAreUnderlined) {
  EXPECT_EQ(plain_text("# One `key`\n\n## Two\n### Three\ntext\n", 80),
            "One `key`\n=========\n\nTwo\n---\n\nThree\n\ntext\n");
  EXPECT_EQ(title_of("<!-- x -->\n# A [link](keys.md) and **more**\n# Second\n"),
            "A link (`palpate help keys`) and more");
  EXPECT_EQ(title_of("no title\n"), "");
}

TEST(PlainText, ParagraphsAndListsAreFilled) {
  EXPECT_EQ(plain_text("one two\nthree four\n\nnext\n", 13), "one two three\nfour\n\nnext\n");
  EXPECT_EQ(plain_text("- one two\n  three\n- four\n\n1. five six\n", 9),
            "- one two\n  three\n- four\n\n1. five\n   six\n");
  EXPECT_EQ(plain_text("averyveryverylongword and\n", 5), "averyveryverylongword\nand\n");
}

TEST(PlainText, CodeStaysAsItIs) {
  EXPECT_EQ(plain_text("a:\n```sh\n./palpate run  x   # **no** [link](y.md)\n\n# z\n```\nb\n", 20),
            "a:\n\n    ./palpate run  x   # **no** [link](y.md)\n\n    # z\n\nb\n");
  EXPECT_EQ(plain_text("`a **b** [c](d.md)`\n", 80), "`a **b** [c](d.md)`\n");
}

TEST(PlainText, LinksSayWhereTheyLead) {
  EXPECT_EQ(plain_text("see [keys.md](keys.md), [all keys](keys.md#body)\n", 99),
            "see `palpate help keys`, all keys (`palpate help keys`)\n");
  EXPECT_EQ(plain_text("[here](#part) [there](https://example.org/a)\n", 99),
            "here there (https://example.org/a)\n");
  EXPECT_EQ(plain_text("[`[[body]]`](#body) [`a`](keys.md)\n", 99), "`[[body]]` `a` (`palpate help keys`)\n");
  EXPECT_EQ(plain_text("![A ball.](scenes/ball.png)\n", 99), "[picture: A ball.]\n");
  EXPECT_EQ(plain_text("[[contact]] and [0, 1] (closed)\n", 99), "[[contact]] and [0, 1] (closed)\n");
}

TEST(PlainText, TablesAreAlignedOrGivenLineByLine) {
  const std::string table = "| key | what |\n|---|---|\n| `a` | one \\| two |\n| `long` | |\n\nend\n";
  const std::string wide = plain_text(table, 80);
  EXPECT_NE(wide.find("key     what\n"), std::string::npos) << wide;
  EXPECT_NE(wide.find("`a`     one | two\n"), std::string::npos) << wide;
  EXPECT_EQ(plain_text(table, 12), "`a`\n    what:\n      one |\n      two\n`long`\n\nend\n");
}

TEST(PlainText, CommentsAreLeftOut) { EXPECT_EQ(plain_text("<!-- made\nby x -->\nb\n", 80), "b\n"); }

TEST(PlainText, NoLineOfTextIsWiderThanAsked) {
  std::string text;
  for (int i = 0; i < 200; ++i)
    text += "word" + std::string(static_cast<std::size_t>(i % 9), 'x') + (i % 7 ? " " : "\n");
  for (const std::size_t width : {40u, 72u, 100u}) {
    std::istringstream lines(plain_text(text, width));
    std::size_t widest = 0;
    for (std::string line; std::getline(lines, line);) widest = std::max(widest, line.size());
    EXPECT_LE(widest, width);
    EXPECT_GT(widest, width - 14) << "lines are filled";
  }
}

}  // namespace
