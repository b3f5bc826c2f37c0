#include "report/table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "palpate/core/error.h"
#include "temporary_folder.h"

using namespace palpate;

namespace {

std::string message_of(const std::filesystem::path& path) {
  try {
    report::read_csv(path);
  } catch (const Error& e) { return e.what(); }
  return "no error";
}

}  // namespace

TEST(BrokenLines, FitTheWidthAndLoseNoWord) {
  const std::vector<std::string> headers = {"name", "what it is"};
  const report::Rows rows = {{"a", "one two three four five six seven eight nine ten"}, {"longer", "short"}};
  const report::Rows broken = report::with_broken_lines(headers, rows, 30);
  ASSERT_EQ(broken.size(), 4u);
  EXPECT_EQ(broken[0], (std::vector<std::string>{"a", "one two three four"}));
  EXPECT_EQ(broken[1], (std::vector<std::string>{"", "five six seven eight"}));
  EXPECT_EQ(broken[2], (std::vector<std::string>{"", "nine ten"}));
  EXPECT_EQ(broken[3], rows[1]);
  std::istringstream lines(report::format_table(headers, broken));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 30u) << line;
  EXPECT_EQ(report::with_broken_lines(headers, rows, 0), rows) << "no terminal";
  EXPECT_EQ(report::with_broken_lines(headers, rows, 25), rows) << "too narrow for words";
}

TEST(FormatTable, SetsNumbersToTheRightAndWordsToTheLeft) {
  const std::string text =
      report::format_table({"name", "error"}, {{"a", "1e-05"}, {"longer", "0.25"}, {"none", "-"}});
  EXPECT_EQ(text,
            "name    error\n"
            "------  -----\n"
            "a       1e-05\n"
            "longer   0.25\n"
            "none        -\n");
}

TEST(FormatTable, CountsCodePointsNotBytes) {
  const std::string text = report::format_table({"ω [rad/s]", "b"}, {{"é", "x"}});
  EXPECT_EQ(text, "ω [rad/s]  b\n---------  -\né          x\n");
}

TEST(FormatTable, LeavesNoBlanksAtTheEndOfALine) {
  const std::string text = report::format_table({"a", "b"}, {{"x", "longer"}, {"y", "z"}});
  EXPECT_EQ(text.find(" \n"), std::string::npos);
}

TEST(FormatTable, RefusesARaggedRow) {
  EXPECT_THROW(report::format_table({"a", "b"}, {{"only one"}}), InternalError);
}

TEST(ReadCsv, KeepsCellsAsTextAndGivesColumnsAsNumbers) {
  const TemporaryFolder folder;
  const report::Table table =
      report::read_csv(folder.write("good.csv", "a,b\n1.5,\"x, \"\"y\"\"\"\nnan,z\n"));
  EXPECT_EQ(table.headers, (std::vector<std::string>{"a", "b"}));
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0][1], "x, \"y\"");
  const std::vector<double> a = table.numbers("a");
  EXPECT_EQ(a[0], 1.5);
  EXPECT_TRUE(std::isnan(a[1]));
}

TEST(ReadCsv, NamesTheFileThatIsWrong) {
  const TemporaryFolder folder;
  for (const char* text : {"a,b\n1,2\n3\n", "a,b\n1,\"2\n", ""})
    EXPECT_NE(message_of(folder.write("bad.csv", text)).find("bad.csv:"), std::string::npos) << text;
  EXPECT_NE(message_of("/nowhere/at/all.csv").find("/nowhere/at/all.csv"), std::string::npos);
}

TEST(Table, NamesTheNearestColumn) {
  report::Table table;
  table.headers = {"time_s", "force_x_n"};
  table.source = "force.csv";
  try {
    table.column("time");
    FAIL() << "an unknown column was accepted";
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "force.csv: has no column \"time\" (did you mean \"time_s\"?)");
  }
}

TEST(ToNumber, TakesExactlyOneNumber) {
  EXPECT_EQ(report::to_number("-1.5e3"), -1500.0);
  for (const char* bad : {"", "1,5", "1.5 m", " 1", "x"})
    EXPECT_TRUE(std::isnan(report::to_number(bad))) << bad;
}

TEST(ShortCell, ShortensFractionsOnly) {
  EXPECT_EQ(report::short_cell("0.123456"), "0.123");
  EXPECT_EQ(report::short_cell("123456"), "123456");
  EXPECT_EQ(report::short_cell("123456.0"), "123456");
  EXPECT_EQ(report::short_cell("cvode-bdf"), "cvode-bdf");
  EXPECT_EQ(report::short_cell(""), "-");
  EXPECT_EQ(report::short_cell("nan"), "-");
}
