#include "store/study_db.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "palpate/core/error.h"
#include "store/content_hash.h"
#include "temporary_folder.h"

using namespace palpate;
using namespace std::string_literals;
namespace fs = std::filesystem;

namespace {

class StudyDbTest : public testing::Test {
 protected:
  const TemporaryFolder own_;
  fs::path folder_ = own_.path();
  std::string path_ = (folder_ / "study.sqlite").string();
};

store::StudyRun sample(const std::string& key, int repeat) {
  return {key,
          repeat,
          "scene; drop table run",
          "a 'label'",
          "cvode-bdf",
          "rtol",
          1e-3,
          "failed",
          "because\nof this",
          {0.1, std::nan(""), 9007199254740991.0}};
}

const std::vector<std::string> kColumns = {"error", "force error", "steps"};

TEST_F(StudyDbTest, KeepsRowsToTheBit) {
  {
    store::StudyDb db(path_, kColumns);
    db.put(sample("k", 1));
    db.put(sample("k", 0));
    db.put(sample("other", 0));
    db.put(sample("k", 1));  // again: replaced
  }
  const store::StudyDb db(path_, kColumns);
  EXPECT_EQ(db.run_count(), 3);
  const auto runs = db.runs("k");
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[1].repeat, 1);
  EXPECT_EQ(runs[0].label, "a 'label'");
  EXPECT_EQ(runs[0].scene, "scene; drop table run");
  EXPECT_EQ(runs[0].reason, "because\nof this");
  EXPECT_EQ(runs[0].numbers[0], 0.1);
  EXPECT_TRUE(std::isnan(runs[0].numbers[1]));
  EXPECT_EQ(runs[0].numbers[2], 9007199254740991.0);
  EXPECT_TRUE(db.runs("unknown").empty());
}

TEST_F(StudyDbTest, KeepsBytes) {
  const std::string bytes = "\0\1\xff with a zero \0 inside"s;
  ASSERT_EQ(bytes.size(), 24u);
  store::StudyDb db(path_, kColumns);
  EXPECT_FALSE(db.artefact("r"));
  db.put(store::StudyArtefact{"r", "reference", "ok", "", 1.5, bytes});
  const auto kept = db.artefact("r");
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->bytes, bytes);
  EXPECT_EQ(kept->cpu_s, 1.5);
}

TEST_F(StudyDbTest, RefusesOtherColumnsAndOtherFiles) {
  { store::StudyDb db(path_, kColumns); }
  try {
    store::StudyDb db(path_, {"error"});
    FAIL() << "other columns were accepted";
  } catch (const Error& e) { EXPECT_NE(std::string(e.what()).find("--fresh"), std::string::npos); }
  const std::string text = (folder_ / "text.sqlite").string();
  std::ofstream(text) << std::string(5000, 'x');
  EXPECT_THROW(store::StudyDb(text, kColumns), Error);
  EXPECT_THROW(store::StudyDb("/nowhere/study.sqlite", kColumns), Error);
}

// Values from an independent implementation with integers of any size (Python).
TEST(ContentHash, IsFnv1aOf128Bits) {
  EXPECT_EQ(store::ContentHash().hex(), "6c62272e07bb014262b821756295c58d");
  EXPECT_EQ(store::ContentHash().add("a").hex(), "a68c894e6e8b5822836dbc791ef90399");  // hash of "1:a"
  // hash of "3:abc2:de"
  EXPECT_EQ(store::ContentHash().add("abc").add("de").hex(), "91f3dfb4b204f1aebf68bef937b780e7");
  EXPECT_NE(store::ContentHash().add("ab").add("cde").hex(), store::ContentHash().add("abc").add("de").hex());
}

}  // namespace
