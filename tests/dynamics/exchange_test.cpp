#include "palpate/dynamics/exchange.h"

#include <gtest/gtest.h>

#include <thread>

using namespace palpate;
using namespace palpate::dynamics;

namespace {

// A record in which every field encodes the version: a torn copy would mix two versions.
LinearisedContact marked(std::uint64_t version) {
  LinearisedContact r;
  r.version = version;
  const double v = static_cast<double>(version);
  r.time = v;
  r.F0.fill(v);
  r.J.fill(v);
  r.B.fill(v);
  return r;
}

TEST(Exchange, RecordsAreNeverTornNorGoBackwards) {
  Exchange<LinearisedContact> exchange;
  constexpr std::uint64_t kRecords = 200000;
  std::thread writer([&] {
    for (std::uint64_t v = 1; v <= kRecords; ++v) exchange.publish(marked(v));
  });
  std::uint64_t last = 0;
  long torn = 0, backwards = 0, seen = 0;
  while (last < kRecords) {
    const LinearisedContact r = exchange.latest();
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
  EXPECT_EQ(exchange.latest().version, kRecords);
}

TEST(Exchange, FitsAnyPlainRecord) {  // a second record type for the interface: a plain clock
  struct Clock {
    double t;
  };
  Exchange<Clock> exchange;
  EXPECT_EQ(exchange.latest().t, 0.0);
  exchange.publish({1.5});
  exchange.publish({2.5});
  EXPECT_EQ(exchange.latest().t, 2.5);
}

TEST(LinearisedContact, IsLinearInPoseAndTwistAboutItsRecord) {
  LinearisedContact r = marked(1);
  EXPECT_EQ(contact_wrench(r, 0.0, {}, {}).norm(), 0.0) << "a record made from nothing pushes nothing";
  r.source = LinearisedContact::Source::kFrozen;
  r.F0 = {0, 0, 0, 0, 0, 2};
  r.J.fill(0);
  r.B.fill(0);
  r.J[35] = -100;  // dFz/dz
  r.J[0] = -3;     // dMx/d(rotation about x)
  r.B[35] = -4;
  const Pose pose{quaternion_of(Vec3(0.2, 0, 0)), Vec3(0, 0, 0.01)};
  Twist twist;
  twist.linear = Vec3(0, 0, 0.5);
  r.v0 = {0, 0, 0, 0, 0, 0.25};
  const Vec6 w = contact_wrench(r, 3.25, pose, twist);
  EXPECT_NEAR(w[5], 2 - 1 - 1, 1e-12);
  EXPECT_NEAR(w[0], -0.6, 1e-12);
}

}  // namespace
