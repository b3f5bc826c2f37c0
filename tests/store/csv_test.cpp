#include "store/csv.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/force_file.h"
#include "store/sample_run.h"

using namespace palpate;

namespace {

TEST(Csv, NumbersReadBackToTheLastBit) {
  const sample_run::Folder folder;
  const std::vector<double> odd = {
      0.1 + 0.2, -1e-308, 5e-324, 1e300, 0.0, -0.0, std::numeric_limits<double>::max()};
  store::CsvWriter csv(folder / "a.csv", {"time_s", "force_n"});
  for (const double x : odd) csv.row(std::array{x, -x});
  csv.row(std::array{1.0, std::nan("")});
  csv.close();
  const store::CsvTable table = store::read_csv(folder / "a.csv");
  std::vector<double> again = table.numbers("time_s");
  EXPECT_EQ(again.back(), 1.0);
  EXPECT_TRUE(std::isnan(table.numbers("force_n").back()));
  again.pop_back();
  EXPECT_EQ(again, odd);
  EXPECT_EQ(csv.rows(), 8);
}

TEST(Csv, TextWithCommasQuotesAndLineEnds) {
  const sample_run::Folder folder;
  const std::string awkward = "a \"b\", c\nd";
  {
    store::CsvWriter csv(folder / "a.csv", {"name", "x, or y"});
    csv.row(std::vector<store::CsvCell>{awkward, 2.0});
    csv.row(std::vector<store::CsvCell>{std::string(), 3.0});
  }
  const store::CsvTable table = store::read_csv(folder / "a.csv");
  EXPECT_EQ(table.column("name"), (std::vector<std::string>{awkward, ""}));
  EXPECT_EQ(table.numbers("x, or y"), (std::vector<double>{2.0, 3.0}));
}

std::string refusal(const auto& action) {
  try {
    action();
  } catch (const Error& e) { return e.what(); }
  return "accepted";
}

TEST(Csv, AFullDiskIsSaidAtTheFlush) {
  store::CsvWriter csv("/dev/full", {"a"});
  csv.row(std::array{1.0});
  EXPECT_EQ(refusal([&] { csv.flush(); }),
            "/dev/full: cannot be written further (No space left on device); is the disk full?");
  store::ForceFile forces("/dev/full");
  forces.append({});
  EXPECT_NE(refusal([&] { forces.close(); }), "accepted");
}

TEST(Csv, AKilledWritersLastLineDoesNotCount) {
  const sample_run::Folder folder;
  store::write_atomically(folder / "a.csv", "a,b\n1,2\n3,4.");
  EXPECT_EQ(store::read_csv(folder / "a.csv").numbers("b"), std::vector<double>{2.0});
  store::write_atomically(folder / "a.csv", "a,b\n1,2\n3");
  EXPECT_EQ(store::read_csv(folder / "a.csv").numbers("a"), std::vector<double>{1.0});
}

TEST(Csv, LinesReachTheFileWhole) {
  const sample_run::Folder folder;
  store::CsvWriter csv(folder / "a.csv", {"a", "b"});
  for (int i = 0; i < 30000; ++i) {
    csv.row(std::array{0.1 * i, -0.1 * i});
    if (i % 500 != 0) continue;
    const std::string written = store::read_file(folder / "a.csv");
    ASSERT_TRUE(written.empty() || written.back() == '\n') << "row " << i;
  }
}

TEST(Csv, ErrorsSayWhere) {
  const sample_run::Folder folder;
  const std::string path = folder / "a.csv";
  const auto read = [&](const std::string& text, const std::string& header) {
    store::write_atomically(path, text);
    return refusal([&] { store::read_csv(path).numbers(header); });
  };
  EXPECT_EQ(read("", "a"), path + ": is empty, must begin with a line of headers");
  EXPECT_EQ(read("a,b\n1,2\n3\n", "a"), path + ": row 2 has 1 cells, must have 2");
  EXPECT_EQ(read("a,b\r\n1,2\r\n", "a"), "accepted") << "as Windows writes it";
  EXPECT_EQ(read("force_n\n1\n", "force_m"), "no column \"force_m\" (did you mean \"force_n\"?)");
  EXPECT_EQ(read("a\n1\n2x\n", "a"), "column \"a\", row 2: \"2x\" is not a number");
  EXPECT_NE(
      read("a\n1\n9007199254740993\n", "a").find("column \"a\", row 2: 9007199254740993 must be at most"),
      std::string::npos);
  EXPECT_EQ(read("a\n9007199254740992\n1e300\n", "a"), read("a\n1\n", "a")) << "accepted";
  EXPECT_EQ(read("a\n1\n\"2\n", "a"), path + ":3: unterminated quote");
  EXPECT_EQ(refusal([] { store::CsvWriter csv("/no/such/a.csv", {"a"}); }),
            "/no/such/a.csv: cannot be written (No such file or directory); check that its folder exists, is "
            "writable and is not full");
  EXPECT_EQ(refusal([] { store::read_csv("/no/such.csv"); }),
            "/no/such.csv: no such file, or it cannot be read");
  store::CsvWriter csv(path, {"a", "b"});
  EXPECT_THROW(csv.row(std::array{1.0}), InternalError);
}

TEST(Csv, AFullDiskIsReported) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  store::CsvWriter csv("/dev/full", {"a"});
  csv.row(std::array{1.0});
  EXPECT_EQ(refusal([&] { csv.close(); }),
            "/dev/full: cannot be written further (No space left on device); is the disk full?");
}

TEST(ForceFile, RoundTrip) {
  const sample_run::Folder folder;
  store::ForceRow row{0.125,
                      {quaternion_of({0.1, 0.2, 0.3}), {1, 2, 3}},
                      {quaternion_of({0, 0, -1.5}), {4, 5, 6}},
                      {{7, 8, 9}, {10, 11, 12}},
                      true,
                      5};
  {
    store::ForceFile file(folder / "force.csv");
    file.append(row);
    row.time_s = 0.126;
    row.limited = false;
    row.switches = 0;
    file.append(row);
    file.close();
  }
  const auto rows = store::read_forces(folder / "force.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].time_s, 0.125);
  EXPECT_TRUE(rows[0].limited);
  EXPECT_FALSE(rows[1].limited);
  EXPECT_EQ(rows[0].switches, 5u);
  EXPECT_EQ(rows[1].switches, 0u);
  EXPECT_EQ(rows[1].on_hand.force, Vec3(10, 11, 12));
  EXPECT_EQ(rows[1].on_hand.moment, Vec3(7, 8, 9));
  EXPECT_EQ(rows[1].tool.translation, Vec3(4, 5, 6));
  EXPECT_LE(rows[1].handle.rotation.angularDistance(row.handle.rotation), 1e-15);
  EXPECT_EQ(store::read_csv(folder / "force.csv").numbers("force_x_n"), (std::vector<double>{10, 10}));
  EXPECT_EQ(store::force_headers().size(), 21u);
}

TEST(AtomicFile, ReplacesWholeAndLeavesNothingBeside) {
  const sample_run::Folder folder;
  store::write_atomically(folder / "a.txt", "one");
  store::write_atomically(folder / "a.txt", "two");
  EXPECT_EQ(store::read_file(folder / "a.txt"), "two");
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder / "")) ++files;
  EXPECT_EQ(files, 1);
  EXPECT_EQ(refusal([] { store::write_atomically("/no/such/a.txt", "x"); }),
            "/no/such/a.txt: cannot be written (No such file or directory); check that its folder exists, is "
            "writable and is not full");
}

}  // namespace
