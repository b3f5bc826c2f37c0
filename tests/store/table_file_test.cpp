// Growing tables: rows are read back as written, complete up to the last flush.
#include "store/table_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "palpate/core/error.h"

namespace {

using namespace palpate;

const std::vector<store::TableSpec> kTables = {{"ticks", {"time_s", "force_n"}}, {"exchanges", {"version"}}};

std::string file(const char* name) { return (std::filesystem::path(::testing::TempDir()) / name).string(); }

TEST(TableFile, RowsComeBack) {
  const std::string path = file("tables.h5");
  {
    store::TableFile out(path, kTables);
    for (int i = 0; i < 1000; ++i) out.append(0, std::vector<double>{1e-3 * i, 1.0 / (i + 3)});
    out.append(1, std::vector<double>{7.0});
  }
  const store::Table ticks = store::read_table(path, "ticks"),
                     exchanges = store::read_table(path, "exchanges");
  EXPECT_EQ(ticks.columns, kTables[0].columns);
  ASSERT_EQ(ticks.rows(), 1000u);
  for (std::size_t i = 0; i < 1000; ++i) {
    EXPECT_EQ(ticks.row(i)[0], 1e-3 * static_cast<double>(i));
    EXPECT_EQ(ticks.row(i)[1], 1.0 / static_cast<double>(i + 3));
  }
  ASSERT_EQ(exchanges.rows(), 1u);
  EXPECT_EQ(exchanges.row(0)[0], 7.0);
}

// A copy taken while the file is open represents a killed process.
TEST(TableFile, WhatWasFlushedIsWhole) {
  const std::string path = file("open.h5"), copy = file("copy.h5");
  store::TableFile out(path, kTables);
  for (int i = 0; i < 300; ++i) out.append(0, std::vector<double>{1.0 * i, 0.0});
  out.flush();
  std::filesystem::copy_file(path, copy, std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(store::read_table(copy, "ticks").rows(), 300u);
  EXPECT_EQ(store::read_table(copy, "exchanges").rows(), 0u);
}

TEST(TableFile, SaysWhatIsMissing) {
  const auto message = [](auto&& call) {
    try {
      call();
    } catch (const Error& e) { return std::string(e.what()); }
    return std::string();
  };
  const std::string path = file("few.h5");
  { store::TableFile out(path, kTables); }
  EXPECT_NE(message([&] { store::read_table(path, "forces"); }).find("forces"), std::string::npos);
  EXPECT_NE(message([&] { store::read_table(file("none.h5"), "ticks"); }).find("no such file"),
            std::string::npos);
  std::ofstream(file("text.h5")) << "not HDF5";
  EXPECT_NE(message([&] { store::read_table(file("text.h5"), "ticks"); }).find("not an HDF5 file"),
            std::string::npos);
  EXPECT_NE(message([&] { store::TableFile("/nowhere/at/all.h5", kTables); }).find("/nowhere/at/all.h5"),
            std::string::npos);
}

}  // namespace
