// Checkpoints on disk, and the files that a resumed run continues.
#include "store/checkpoint_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "messages.h"
#include "palpate/core/error.h"
#include "palpate/store/run_file.h"
#include "store/atomic_file.h"
#include "store/csv.h"
#include "store/sample_run.h"
#include "store/table_file.h"

namespace {

using namespace palpate;
using palpate::expectations::message_of;

store::Checkpoint sample() {
  store::Checkpoint out{"1.2.3 (abc)", 0.1, "[scene]\nname = \"x\"\n", {}};
  std::vector<double> numbers(500);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = 1.0 / (static_cast<double>(i) + 3.0);
  out.values["state.q"] = numbers;
  out.values["none"] = std::vector<double>{};
  out.values["count"] = std::vector<std::int64_t>{-5, 1L << 60};
  out.values["record"] = std::string("\0\1\2", 3);
  out.values["empty text"] = std::string();
  return out;
}

TEST(CheckpointFile, ComesBackAsItWasWritten) {
  const sample_run::Folder folder;
  const std::string path = folder / "checkpoint.h5";
  for (int i = 0; i < 2; ++i) store::write_checkpoint(path, sample());  // the second replaces the first
  const store::Checkpoint back = store::read_checkpoint(path);
  EXPECT_EQ(back.version, sample().version);
  EXPECT_EQ(back.time_s, 0.1);
  EXPECT_EQ(back.scene_source, sample().scene_source);
  EXPECT_EQ(back.values, sample().values);
  int files = 0;
  for ([[maybe_unused]] const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(path).parent_path()))
    ++files;
  EXPECT_EQ(files, 1) << "nothing temporary is left";
}

// However the file was damaged: it is rejected with its name, or its content is what was written.
TEST(CheckpointFile, NeverSaysWhatWasNotWritten) {
  const sample_run::Folder folder;
  const std::string path = folder / "checkpoint.h5";
  store::write_checkpoint(path, sample());
  const std::string good = store::read_file(path);
  std::mt19937 random(3);
  int refused = 0;
  const auto look_at = [&](const std::string& bytes) {
    store::write_atomically(path, bytes);
    try {
      EXPECT_EQ(store::read_checkpoint(path).values, sample().values);
    } catch (const Error& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()).find(path + ": is not a valid checkpoint"), std::string::npos)
          << error.what();
    }
  };
  for (std::size_t size = 0; size < good.size(); size += 1 + good.size() / 97) look_at(good.substr(0, size));
  EXPECT_GT(refused, 90) << "every shorter file";
  for (int i = 0; i < 400; ++i) {
    std::string bytes = good;
    bytes[random() % bytes.size()] ^= static_cast<char>(1u << random() % 8);
    look_at(bytes);
  }
  EXPECT_GT(refused, 150) << "most flipped bits: others are in room that holds nothing";
  EXPECT_NE(message_of([&] { store::read_checkpoint(folder / "none.h5"); }).find("no such file"),
            std::string::npos);
}

TEST(GoingOn, ATableFileIsMadeAnewFromItsJournal) {
  const sample_run::Folder folder;
  const std::string path = folder / "tables.h5", other = folder / "other.h5";
  const std::vector<store::TableSpec> tables = {{"ticks", {"t", "f"}}, {"exchanges", {"version"}}};
  const auto fill = [](store::TableFile& file, int from, int to) {
    for (int i = from; i < to; ++i) {
      file.append(0, std::vector<double>{0.1 * i, 1.0 / (i + 1)});
      if (i % 10 == 0) file.append(1, std::vector<double>{1.0 * i});
    }
  };
  store::TableFile::Journal place;
  {
    store::TableFile file(path, tables, store::TableFile::Journal{});
    fill(file, 0, 700);
    place = file.place();
    fill(file, 700, 900);  // truncated
  }
  store::write_atomically(path, "what a kill left of it");
  {
    store::TableFile file(path, tables, place);
    fill(file, 700, 1000);
    store::TableFile whole(other, tables);
    fill(whole, 0, 1000);
  }
  for (const char* name : {"ticks", "exchanges"})
    EXPECT_EQ(store::read_table(path, name).values, store::read_table(other, name).values) << name;
  const std::string journal = store::TableFile::journal_path(path);
  const std::string rows = store::read_file(journal);
  const auto again = [&] { store::TableFile file(path, tables, place); };
  store::write_atomically(journal, rows.substr(0, 100));
  EXPECT_NE(message_of(again).find("had " + std::to_string(place.bytes)), std::string::npos);
  const std::string tables_before = store::read_file(path);
  for (const std::size_t at : {std::size_t{0}, std::size_t{8}, static_cast<std::size_t>(place.bytes) / 2,
                               static_cast<std::size_t>(place.bytes) - 1}) {
    std::string flipped = rows;
    flipped[at] ^= 0x10;
    store::write_atomically(journal, flipped);
    EXPECT_NE(message_of(again).find(journal + ": differs from its content at the checkpoint"),
              std::string::npos)
        << at;
  }
  EXPECT_EQ(store::read_file(path), tables_before) << "what is rejected stays as it is";
  std::filesystem::remove(journal);
  EXPECT_NE(message_of(again).find("cannot be resumed without this file"), std::string::npos);
}

TEST(GoingOn, ATextFileIsCutBack) {
  const sample_run::Folder folder;
  const std::string path = folder / "force.csv";
  store::CsvWriter::Place place;
  {
    store::CsvWriter file(path, {"t", "f"});
    file.row(std::vector<double>{0.0, 1.0});
    place = file.place();
    file.row(std::vector<double>{1.0, 2.0});
  }
  {
    store::CsvWriter file(path, {"t", "f"}, place);
    EXPECT_EQ(file.rows(), 1);
    file.row(std::vector<double>{1.0, 3.0});
  }
  EXPECT_EQ(store::read_file(path), "t,f\n0,1\n1,3\n");
  for (const char* changed : {"t,g\n0,1\n1,3\n", "t,f\n0,3\n1,3\n"}) {
    store::write_atomically(path, changed);
    EXPECT_NE(message_of([&] {
                store::CsvWriter file(path, {"t", "f"}, place);
              }).find("differs from its content"),
              std::string::npos);
    EXPECT_EQ(store::read_file(path), changed) << "what is rejected stays as it is";
  }
  store::write_atomically(path, "t,f\n0,1\n9,9\n");  // rows after the checkpoint are computed again
  EXPECT_EQ(message_of([&] { store::CsvWriter file(path, {"t", "f"}, place); }), "");
}

TEST(GoingOn, AFileOfStatesKeepsItsFirstSteps) {
  const sample_run::Folder folder;
  const std::string path = folder / "run.vtkhdf";
  const auto parts = sample_run::parts();
  const store::RunInfo info = sample_run::info(4);
  const auto append = [&](store::RunFile& file, int from, int to) {
    for (int i = from; i < to; ++i) sample_run::append(file, i);
  };
  store::RunFile::Place place;
  {
    store::RunFile file(path, parts, info);
    append(file, 0, 2);
    place = file.place();
    append(file, 2, 4);
  }
  const store::RunReader before(path);
  {
    store::RunFile file = store::RunFile::continued(path, parts, info, place);
    EXPECT_EQ(file.steps(), 2);
    append(file, 2, 4);
  }
  const store::RunReader after(path);
  ASSERT_EQ(after.steps(), 4);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(after.points(i), before.points(i));
    EXPECT_EQ(after.displacement(i), before.displacement(i));
    EXPECT_EQ(after.velocity(i), before.velocity(i));
    EXPECT_EQ(after.stress(i), before.stress(i));
  }
  EXPECT_NE(message_of([&] {
              store::RunFile::continued(path, parts, info, {9, ""});
            }).find("had 9 at the checkpoint"),
            std::string::npos);
  EXPECT_NE(message_of([&] {
              store::RunFile::continued(path, {}, info, {1, ""});
            }).find("are not those of the scene"),
            std::string::npos);
}

TEST(GoingOn, AFlippedBitInAStateIsFound) {
  const sample_run::Folder folder;
  const std::string path = folder / "run.vtkhdf";
  const auto parts = sample_run::parts();
  const store::RunInfo info = sample_run::info(3);
  double next = 0.001;
  const auto fill = [&](auto values) {
    for (double& value : values.reshaped()) value = next += 0.001;
    return values;
  };
  store::RunFile::Place place;
  {
    store::RunFile file(path, parts, info);
    for (int i = 0; i < 3; ++i)
      file.append(i, fill(sample_run::points(i)), fill(sample_run::velocity(i)), fill(sample_run::stress(i)));
    place = file.place();
  }
  const std::string whole = store::read_file(path);
  int found = 0;
  for (double value = 0.002; value < next + 5e-4; value += 0.001) {  // each number occurs in the file once
    double exact = 0.001;
    while (exact < value - 5e-4) exact += 0.001;  // by the same additions
    const std::size_t at = whole.find(std::string(reinterpret_cast<const char*>(&exact), sizeof exact));
    if (at == std::string::npos) continue;
    std::string flipped = whole;
    flipped[at] ^= 1;
    store::write_atomically(path, flipped);
    EXPECT_NE(
        message_of([&] { store::RunFile::continued(path, parts, info, place); }).find("its states differ"),
        std::string::npos);
    EXPECT_EQ(store::read_file(path), flipped) << "what is rejected stays as it is";
    ++found;
  }
  EXPECT_GT(found, 3 * 7 * sample_run::kPoints / 2);
}

}  // namespace
