// Statistics of a query in image space: time per stage, and amounts of work.
#include "two_balls.h"

using namespace contact_tests;

// The four stages are parts of the total image time, which an outer clock measures. A thread may be suspended
// between two of them, on a busy machine for long, but not in each of a hundred queries.
TEST(QueryWork, TheTimeOfImagesIsThatOfTheirStages) {
  TwoBalls balls;
  contact::ContactForce term;
  term.add_pair(balls.source(true), ContactSpec{});
  term.add_pair(balls.source(false), ContactSpec{});
  term.refresh(balls.state.view());
  for (const contact::PairReport& pair : term.pairs()) {
    const contact::QueryStages* s = pair.stages;
    ASSERT_TRUE(s);
    const auto parts = [s] { return s->upload_s + s->passes_s + s->gather_s + s->readback_s; };
    double share = parts() / s->images_s;
    for (int k = 0; k < 100 && share <= 0.5; ++k) {
      const double parts_before = parts(), images_before = s->images_s;
      term.refresh(balls.state.view());
      share = (parts() - parts_before) / (s->images_s - images_before);
    }
    EXPECT_GT(share, 0.5);
    EXPECT_LE(parts(), 1.000001 * s->images_s);
    EXPECT_GT(s->passes_s, 0.0);
    EXPECT_GT(s->upload_s, 0.0);
    EXPECT_GT(s->gather_s, 0.0);
    EXPECT_GT(s->readback_s, 0.0);
  }
}

// Skins are evaluated together with the positions; patches include only the transform of the faces to contact
// axes.
TEST(QueryWork, SkinsAreTimedWithThePositions) {
  TwoBalls balls;
  const auto source = balls.source(true);
  std::vector<contact::ContactSample> samples;
  source->query(balls.state.view(), samples);
  EXPECT_GT(source->report().stages->positions_s, 0.0);
  EXPECT_GT(source->report().stages->patches_s, 0.0);
}

// One image of both whole skins: all of their vertices are transformed to its axes, and each hit is a sample.
TEST(QueryWork, OneImageIsCounted) {
  TwoBalls balls;
  const auto source = balls.source(false);
  std::vector<contact::ContactSample> samples;
  source->query(balls.state.view(), samples);
  const contact::QueryStages& s = *source->report().stages;
  ASSERT_EQ(s.images, 1);
  EXPECT_EQ(s.vertices, balls.a.model.skin.vertices.cols() + balls.b.model.skin.vertices.cols());
  const auto faces = balls.a.model.skin.faces.cols() + balls.b.model.skin.faces.cols();
  EXPECT_GT(s.faces, faces / 50);  // a cap of either ball, for both sides
  EXPECT_LT(s.faces, faces);
  EXPECT_GT(samples.size(), 40u);
  EXPECT_EQ(s.hits, static_cast<long>(samples.size()));
  EXPECT_GT(s.pairs, 500);
  EXPECT_LE(s.pairs, s.pixels);
}
