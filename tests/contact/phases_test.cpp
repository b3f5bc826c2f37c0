// A query in phases: regions of several pairs, looked at together, have the samples that each has by itself.
#include "two_balls.h"

using namespace contact_tests;

namespace {

bool is_same(const contact::SurfacePoint& p, const contact::SurfacePoint& q) {
  return p.frame == q.frame && p.count == q.count && p.node == q.node && p.weight == q.weight &&
         p.offset == q.offset;
}

}  // namespace

ON_EACH_BACKEND(Phases);

TEST_P(Phases, PairsAreLookedAtTogetherAsOneByOne) {
  TwoBalls balls;
  const TriMesh tool = sphere(Vec3(-0.3, 0.6, 1.2), 0.5, 20);
  const auto frame = contact::fixed_frame();
  const auto sources = [&] {
    std::vector<std::unique_ptr<contact::SampleSource>> out;
    out.push_back(balls.source(true));
    out.push_back(balls.source(false));
    out.push_back(contact::make_image_source(balls.a.surface, tool, 0, frame, balls.options()));
    contact::ImageOptions coarse_first = balls.options();
    coarse_first.quadrature_error = 1e-3;  // rounds of its own
    out.push_back(contact::make_image_source(balls.b.surface, balls.b.proxies, balls.a.surface,
                                             balls.a.proxies, coarse_first));
    return out;
  };
  contact::ContactForce term;
  term.add_frame(frame);
  for (auto& source : sources()) term.add_pair(std::move(source), ContactSpec{});
  for (const double rise : {0.0, 0.02}) {  // a second query uses the first one's memory
    balls.state.q().segment(0, 3 * balls.nodes_of_a()).array() += rise;
    term.refresh(balls.state.view());
    std::size_t at = 0;
    int pair = 0;
    for (auto& source : sources()) {
      SCOPED_TRACE(pair);
      std::vector<contact::ContactSample> alone;
      source->query(balls.state.view(), alone);
      EXPECT_GT(alone.size(), 100u);
      ASSERT_LE(at + alone.size(), term.samples().size());
      for (const contact::ContactSample& s : alone) {
        const contact::ContactSample& t = term.samples()[at++];
        ASSERT_TRUE(t.source == pair && is_same(s.a, t.a) && is_same(s.b, t.b) && s.gap == t.gap &&
                    s.normal == t.normal && s.area == t.area);
      }
      ++pair;
    }
    EXPECT_EQ(at, term.samples().size());
  }
  for (const contact::QueryStages* stages : term.stages()) {
    ASSERT_TRUE(stages);
    EXPECT_GE(stages->images, 2);
    EXPECT_GT(stages->images_s, 0.0);
  }
}
