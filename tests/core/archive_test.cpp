#include "palpate/core/archive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>

#include "core/archive_bytes.h"
#include "messages.h"
#include "palpate/core/error.h"

namespace {

using namespace palpate;
using palpate::expectations::message_of;

enum class Mood { kCalm, kWild };

struct Inner {
  double x = 0.0;
  long count = 0;
  void archive(Archive& a) {
    a("x", x);
    a("count", count);
  }
};

struct Outer {
  bool flag = false;
  Mood mood = Mood::kCalm;
  std::string text;
  std::vector<double> list;
  Vec6 six = Vec6::Zero();
  VecX free;
  Points points;
  Pose pose;
  Twist twist;
  Wrench wrench;
  Inner inner;
  std::deque<Inner> many;
  std::array<Inner, 2> two;
  std::vector<Pose> poses{2};
  struct Plain {
    int a = 0;
    double b = 0.0;
  } plain;
  void archive(Archive& a) {
    a("flag", flag);
    a("mood", mood);
    a("text", text);
    a("list", list);
    a("six", six);
    a("free", free);
    a("points", points);
    a("pose", pose);
    a("twist", twist);
    a("wrench", wrench);
    a("inner", inner);
    a.list("many", many, [&](Inner& one) { one.archive(a); });
    a.each("two", two, [&](Inner& one) { one.archive(a); });
    a.rows("poses", poses, [](auto&& f, Pose& one) { f(one); });
    a.bytes("plain", plain);
  }
};

Outer full() {
  Outer o;
  o.flag = true;
  o.mood = Mood::kWild;
  o.text = std::string("a\0b", 3);
  o.list = {1.0 / 3.0, std::nextafter(1.0, 2.0), -0.0, std::numeric_limits<double>::infinity()};
  o.six << 1, 2, 3, 4, 5, 6;
  o.free = VecX::LinSpaced(5, 0.1, 0.9);
  o.points = Points::Random(3, 4);
  o.pose = {quaternion_of(Vec3(0.1, 0.2, 0.3)), Vec3(1, 2, 3)};
  o.twist = {Vec3(4, 5, 6), Vec3(7, 8, 9)};
  o.wrench = {Vec3(1, 0, 1), Vec3(0, 1, 0)};
  o.inner = {0.5, 1L << 60};
  o.many = {{1.5, 1}, {2.5, 2}, {3.5, 3}};
  o.two = {Inner{4.5, 4}, Inner{5.5, 5}};
  o.poses[1] = o.pose;
  o.plain = {7, 0.25};
  return o;
}

Archive::Values kept(Outer o) {
  Archive a;
  o.archive(a);
  return a.values();
}

TEST(Archive, GivesBackWhatItKeptToTheLastBit) {
  const Archive::Values values = kept(full());
  Archive back(values, "file");
  Outer o;
  o.archive(back);
  back.check_all_restored();
  EXPECT_EQ(kept(o), values);
  EXPECT_TRUE(std::signbit(o.list[2]));
  EXPECT_EQ(o.inner.count, 1L << 60);
  EXPECT_EQ(o.many.size(), 3u);
  EXPECT_EQ(o.plain.b, 0.25);
}

TEST(Archive, NamesWhatIsMissingOrDoesNotFit) {
  const Archive::Values values = kept(full());
  const auto given = [&](const Archive::Values& other) {
    Archive back(other, "file.h5");
    Outer o;
    o.archive(back);
    back.check_all_restored();
  };
  for (const auto& [name, value] : values) {
    SCOPED_TRACE(name);
    Archive::Values less = values;
    less.erase(name);
    EXPECT_NE(message_of([&] { given(less); }).find("file.h5: \"" + name + "\" is missing"),
              std::string::npos);
    Archive::Values kind = values;
    kind[name] = std::holds_alternative<std::string>(value) ? Archive::Value(std::vector<double>{1.0})
                                                            : Archive::Value(std::string("text"));
    EXPECT_NE(message_of([&] { given(kind); }).find(name), std::string::npos);
  }
  Archive::Values longer = values, more = values, wide = values, many = values;
  longer["six"] = std::vector<double>(7, 1.0);
  EXPECT_NE(message_of([&] { given(longer); }).find("has 7 numbers, must have 6"), std::string::npos);
  more["other"] = std::vector<double>{1.0};
  EXPECT_NE(message_of([&] { given(more); }).find("unexpected entry \"other\""), std::string::npos);
  wide["points.rows"] = std::vector<std::int64_t>{4};
  EXPECT_NE(message_of([&] { given(wide); }).find("4 rows"), std::string::npos);
  many["many.size"] = std::vector<std::int64_t>{-1};
  EXPECT_NE(message_of([&] { given(many); }).find("-1 elements"), std::string::npos);
}

TEST(Archive, TakesNoNameTwice) {
  Archive a;
  double x = 1.0;
  a("x", x);
  EXPECT_THROW(a("x", x), InternalError);
  const Archive::Group group(a, "in");
  EXPECT_NO_THROW(a("x", x));
}

}  // namespace

namespace {

struct Record {
  double number = 0.0;
  std::string text;
  std::vector<double> list;
  std::vector<long> counts;
  VecX vector;
  bool flag = false;

  void archive(Archive& a) {
    a("number", number);
    a("text", text);
    a("list", list);
    a.list("counts", counts, [&a](long& count) { a("count", count); });
    a("vector", vector);
    a("flag", flag);
  }
};

}  // namespace

TEST(ArchiveBytes, GiveBackTheObjectToTheBit) {
  const Record record{-0.0,
                      std::string("a\0b", 3),
                      {0.1, std::numeric_limits<double>::quiet_NaN(), -1e-310},
                      {3, -9007199254740993},
                      VecX::LinSpaced(4, 0.0, 1.0),
                      true};
  const auto back = restored<Record>(archived(record));
  EXPECT_TRUE(std::signbit(back.number));
  EXPECT_EQ(back.text, record.text);
  ASSERT_EQ(back.list.size(), 3u);
  EXPECT_EQ(back.list[0], 0.1);
  EXPECT_TRUE(std::isnan(back.list[1]));
  EXPECT_EQ(back.list[2], -1e-310);
  EXPECT_EQ(back.counts, record.counts);
  EXPECT_EQ(back.vector, record.vector);
  EXPECT_TRUE(back.flag);
}

TEST(ArchiveBytes, TruncatedOnesAreAnError) {
  const std::string bytes = archived(Record{1.0, "text", {1.0, 2.0}, {3}, VecX::Ones(2), true});
  int refused = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) try {
      restored<Record>(bytes.substr(0, size));
    } catch (const Error&) { ++refused; }
  EXPECT_EQ(refused, static_cast<int>(bytes.size()));
}
