#include "core/csv.h"

#include <gtest/gtest.h>

#include <cmath>

#include "messages.h"
#include "palpate/core/error.h"

namespace {

using namespace palpate;
using palpate::expectations::message_of;
using Cells = std::vector<std::vector<std::string>>;

Cells cells_of(const std::string& text) {
  Cells out;
  for (CsvRow& row : read_csv_text(text, "a.csv")) out.push_back(std::move(row.cells));
  return out;
}

TEST(CsvText, DialectsReadAlike) {
  const Cells expected = {{"a", "b c"}, {"1", ""}, {"", "2"}};
  for (const char* text : {"a,b c\n1,\n,2\n", "a;b c\n1;\n;2", "a\tb c\n1\t\n\t2\n",
                           "a,b c\r\n1,\r\n,2\r\n\r\n", "a,b c\r1,\r,2\r",
                           "\xef\xbb\xbf"
                           "a,b c\n1,\n,2\n",
                           "\n\n a , \"b c\" \n\n1,\n\t\n,2\n   \n\n", "sep=;\na;b c\n1;\n;2\n",
                           "\"a\",\"b c\"\n\"1\",\"\"\n\"\",\"2\"\n"})
    EXPECT_EQ(cells_of(text), expected) << text;
}

TEST(CsvText, TheFirstLineDecidesOnTheDelimiter) {
  EXPECT_EQ(cells_of("a;b\n1,5;2,5\n"), (Cells{{"a", "b"}, {"1,5", "2,5"}}));
  EXPECT_EQ(cells_of("\"a;x;y\",b\n1;5,2\n"), (Cells{{"a;x;y", "b"}, {"1;5", "2"}}))
      << "those in quotes do not count";
  EXPECT_EQ(cells_of("one column\n1 2\n"), (Cells{{"one column"}, {"1 2"}}));
}

TEST(CsvText, QuotesHoldWhatTheyHold) {
  EXPECT_EQ(cells_of("a,b\n\" a \"\"b\"\", \r\nc\",5\" disk\n"),
            (Cells{{"a", "b"}, {" a \"b\", \r\nc", "5\" disk"}}));
}

TEST(CsvText, RowsKnowTheirLines) {
  const auto rows = read_csv_text("\na,b\r\n\r\n\"1\n2\",3\n4,5", "a.csv");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].line, 2);
  EXPECT_EQ(rows[1].line, 4);
  EXPECT_EQ(rows[2].line, 6);
}

TEST(CsvText, WhatIsNoTextInUtf8IsRefused) {
  const auto refusal = [](const std::string& text) {
    return message_of([&] { read_csv_text(text, "a.csv"); });
  };
  EXPECT_EQ(refusal("a,b\n1,\"2\n"), "a.csv:2: unterminated quote");
  EXPECT_EQ(refusal(std::string("\xff\xfe"
                                "a\0,\0",
                                6)),
            "a.csv:1: the file is in UTF-16; save it as CSV in UTF-8");
  EXPECT_EQ(refusal(std::string("\xfe\xff\0a", 4)),
            "a.csv:1: the file is in UTF-16; save it as CSV in UTF-8");
  EXPECT_EQ(refusal(std::string("a,b\n1\0,2\n", 9)),
            "a.csv: contains null bytes, so it is not CSV text; check the path");
  EXPECT_TRUE(read_csv_text("", "a.csv").empty());
}

TEST(CsvNumber, ReadsWhatProgramsWrite) {
  const std::pair<const char*, double> good[] = {{"1", 1.0},   {"+1.0e-03", 1e-3}, {"-2.5E+2", -250.0},
                                                 {"1,5", 1.5}, {"-0,085", -0.085}, {"+1,5e3", 1500.0},
                                                 {".5", 0.5},  {"5.", 5.0}};
  for (const auto& [cell, expected] : good) {
    double value = NAN;
    EXPECT_TRUE(read_csv_number(cell, value)) << cell;
    EXPECT_EQ(value, expected) << cell;
  }
  double value = 7.0;
  for (const char* cell :
       {"", "+", "+-1", "--1", "1 2", "x", "1,2,3", "1.234,5", "1,234.5", "0x10", "1e", "1e999"})
    EXPECT_FALSE(read_csv_number(cell, value)) << cell;
  EXPECT_EQ(value, 7.0);
  EXPECT_TRUE(read_csv_number("nan", value));
  EXPECT_TRUE(std::isnan(value));
}

}  // namespace
