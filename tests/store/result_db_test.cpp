#include "store/result_db.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "palpate/core/error.h"
#include "store/content_hash.h"
#include "temporary_folder.h"

using namespace palpate;
using namespace std::string_literals;
using store::ResultDb;
using store::ResultRow;

namespace {

class ResultDbTest : public testing::Test {
 protected:
  const TemporaryFolder folder_;
  std::string path_ = (folder_ / "results.db").string();
};

ResultRow sample(const std::string& key) {
  ResultRow row;
  row.key = key;
  row.kind = "point";
  row.task = "scene; drop table result";
  row.status = "failed";
  row.reason = "because\nof 'this'";
  row.cpu_s = 0.1;
  row.limit_s = 9007199254740991.0;
  int next = 0;
  for (const auto& [name, value] : row.machine.fields())
    *value = std::string("machine ") + char('a' + next++);
  row.bytes = "\0\1\xff with a zero \0 inside"s;
  return row;
}

TEST_F(ResultDbTest, KeepsRowsToTheBit) {
  {
    ResultDb db(path_);
    db.put(sample("k"));
    db.put(sample("other"));
    ResultRow again = sample("k");
    again.cpu_s = 0.3;
    db.put(again);  // replaced
  }
  const ResultDb db(path_, ResultDb::Access::kRead);
  EXPECT_EQ(db.count(), 2);
  EXPECT_FALSE(db.find("unknown"));
  auto kept = db.find("k");
  ASSERT_TRUE(kept);
  ResultRow expected = sample("k");
  EXPECT_EQ(kept->key, expected.key);
  EXPECT_EQ(kept->kind, expected.kind);
  EXPECT_EQ(kept->task, expected.task);
  EXPECT_EQ(kept->status, expected.status);
  EXPECT_EQ(kept->reason, expected.reason);
  EXPECT_EQ(kept->cpu_s, 0.3);
  EXPECT_EQ(kept->limit_s, expected.limit_s);
  EXPECT_EQ(kept->bytes, expected.bytes);
  EXPECT_EQ(kept->bytes.size(), 24u);
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_EQ(*kept->machine.fields()[i].second, *expected.machine.fields()[i].second) << i;
}

TEST_F(ResultDbTest, CopiesAllRowsOfAnother) {
  ResultDb one(path_), two((folder_ / "two.db").string(), ResultDb::Access::kSingle), none(":memory:");
  one.put(sample("a"));
  two.put(sample("b"));
  two.put(sample("c"));
  one.put_all(two);
  one.put_all(none);
  EXPECT_EQ(one.count(), 3);
  EXPECT_EQ(one.find("c")->bytes, sample("c").bytes);
}

TEST_F(ResultDbTest, ACopyThatFailsLeavesTheDatabaseAsItWas) {
  const std::string damaged = (folder_ / "damaged.db").string();
  {
    ResultDb db(damaged);
    for (const char* key : {"a", "b"}) {
      ResultRow large = sample(key);
      large.bytes.assign(100000, 'x');
      db.put(large);
    }
  }
  // Damages the second row only.
  const std::uintmax_t size = std::filesystem::file_size(damaged);
  std::filesystem::resize_file(damaged, size - 50000);
  std::filesystem::resize_file(damaged, size);
  {
    ResultDb to(path_);
    const ResultDb from(damaged, ResultDb::Access::kSingle);
    EXPECT_THROW(from.check_readable(), Error);
    EXPECT_THROW(to.put_all(from), Error);
    EXPECT_EQ(to.count(), 0);
    to.put(sample("later"));
  }
  EXPECT_TRUE(ResultDb(path_, ResultDb::Access::kRead).find("later")) << "was left in an open transaction";
}

TEST_F(ResultDbTest, RefusesOtherFiles) {
  const std::string text = (folder_ / "text.db").string();
  std::ofstream(text) << std::string(5000, 'x');
  EXPECT_THROW(ResultDb{text}, Error);
  EXPECT_THROW(ResultDb{"/nowhere/results.db"}, Error);
  EXPECT_THROW(ResultDb(path_, ResultDb::Access::kRead), Error) << "there is none";
}

TEST(Machine, IsThisOne) {
  store::Machine machine = store::Machine::here();
  for (const auto& [name, value] : machine.fields()) EXPECT_FALSE(value->empty()) << name;
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
