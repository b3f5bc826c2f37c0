#include "palpate/core/triple_buffer.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <thread>

using namespace palpate;

namespace {

/// A record of the size of a linearised contact.
struct Record {
  std::uint64_t version = 0;
  double time = 0.0;
  std::array<double, 6> F0{};
  std::array<double, 36> J{}, B{};
};

// A record in which every field encodes the version: a torn copy would mix two versions.
Record marked(std::uint64_t version) {
  Record r;
  r.version = version;
  const double v = static_cast<double>(version);
  r.time = v;
  r.F0.fill(v);
  r.J.fill(v);
  r.B.fill(v);
  return r;
}

TEST(TripleBuffer, RecordsAreNeverTornNorGoBackwards) {
  TripleBuffer<Record> buffer;
  constexpr std::uint64_t kRecords = 200000;
  std::thread writer([&] {
    for (std::uint64_t v = 1; v <= kRecords; ++v) buffer.publish(marked(v));
  });
  std::uint64_t last = 0;
  long torn = 0, backwards = 0, seen = 0;
  while (last < kRecords) {
    const Record r = buffer.latest();
    if (r.version == 0) continue;
    const double v = static_cast<double>(r.version);
    torn += r.time != v || r.F0[5] != v || r.J[0] != v || r.J[35] != v || r.B[35] != v;
    backwards += r.version < last;
    seen += r.version != last;
    last = r.version;
  }
  writer.join();
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(backwards, 0);
  EXPECT_GT(seen, 0);
  EXPECT_EQ(buffer.latest().version, kRecords);
}

TEST(TripleBuffer, FitsAnyPlainRecord) {  // a second record type for the interface: a plain clock
  struct Clock {
    double t;
  };
  TripleBuffer<Clock> buffer;
  EXPECT_EQ(buffer.latest().t, 0.0);
  buffer.publish({1.5});
  buffer.publish({2.5});
  EXPECT_EQ(buffer.latest().t, 2.5);
}

}  // namespace
