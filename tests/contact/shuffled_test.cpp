// The order of triangles in a mesh file does not affect the result.
#include "two_balls.h"

using namespace contact_tests;

namespace {

/// Forces and samples of two soft bodies that overlap and slide, with the triangles of each in a given order.
struct Felt {
  VecX force;
  std::vector<contact::ContactSample> samples;
};

Felt felt_by(unsigned order, double friction) {
  TwoBalls balls({.order = order});
  ContactSpec law;
  law.stiffness_pa_m = 1e6;
  law.damping_pa_s_m = 1e4;
  law.friction = friction;
  contact::ContactForce term;
  term.add_pair(balls.source(true), law);
  term.refresh(balls.state.view());
  Felt out{VecX::Zero(balls.state.view().u.size()), {}};
  out.samples.assign(term.samples().begin(), term.samples().end());
  term.add_force(balls.state.view(), out.force);
  return out;
}

}  // namespace

// Two soft bodies through proxies: samples and forces are bitwise equal. Patches, regions, planes and sums
// depend on the triangles' geometry, not on their numbers.
TEST(Shuffled, SamplesAndForcesStayBitByBit) {
  for (const double friction : {0.3, 0.0}) {
    const Felt plain = felt_by(0, friction);
    ASSERT_GT(plain.samples.size(), 50u);
    ASSERT_GT(plain.force.norm(), 100.0);
    for (const unsigned order : {1u, 2u, 3u}) {
      SCOPED_TRACE(testing::Message() << "friction " << friction << ", order " << order);
      const Felt other = felt_by(order, friction);
      ASSERT_EQ(other.samples.size(), plain.samples.size());
      for (std::size_t i = 0; i < plain.samples.size(); ++i) {
        const contact::ContactSample &s = plain.samples[i], &t = other.samples[i];
        ASSERT_EQ(s.gap, t.gap) << i;
        ASSERT_EQ(s.area, t.area) << i;
        ASSERT_EQ(s.normal, t.normal) << i;
        for (const auto& [p, q] : {std::pair(&s.a, &t.a), std::pair(&s.b, &t.b)}) {
          ASSERT_EQ(p->node, q->node) << i;
          ASSERT_EQ(p->weight, q->weight) << i;
          ASSERT_EQ(p->offset, q->offset) << i;
        }
      }
      EXPECT_EQ(other.force, plain.force);
    }
  }
}
