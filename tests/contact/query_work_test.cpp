// What a query says of itself: where its time went, how much it went through, and how many bytes that is.
#include "palpate/contact/query_bytes.h"
#include "two_balls.h"

using namespace contact_tests;

ON_EACH_BACKEND(QueryWork);

// The four are parts of what the images take as a whole, which a clock outside of the backend reads. A thread
// may be set aside between two of them, on a busy machine for long, but not in each of a hundred queries.
TEST_P(QueryWork, TheTimeOfImagesIsThatOfTheirStages) {
  TwoBalls balls;
  contact::ContactForce term;
  term.add_pair(balls.source(true), ContactSpec{});
  term.add_pair(balls.source(false), ContactSpec{});
  term.refresh(balls.state.view());
  for (const contact::QueryStages* s : term.stages()) {
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
    EXPECT_EQ(s->upload_s > 0.0, GetParam() != contact::DepthBackend::kExact);
    EXPECT_EQ(s->gather_s > 0.0, GetParam() != contact::DepthBackend::kExact);
    EXPECT_EQ(s->readback_s > 0.0, GetParam() == contact::DepthBackend::kGpu);
  }
}

// Skins are evaluated with the positions: what is left of the faces is their look along the axes.
TEST_P(QueryWork, SkinsAreTimedWithThePositions) {
  TwoBalls balls;
  const auto source = balls.source(true);
  std::vector<contact::ContactSample> samples;
  source->query(balls.state.view(), samples);
  EXPECT_GT(source->stages()->positions_s, 0.0);
  EXPECT_GT(source->stages()->patches_s, 0.0);
}

// One image of both skins whole, all pixels at once: all of their vertices are put in its axes, each sample
// was a hit, and each hit a pair of faces.
TEST_P(QueryWork, OneImageIsCounted) {
  TwoBalls balls;
  contact::ImageOptions options = balls.options();
  options.quadrature_error = 0.0;
  const auto source = balls.source(false, options);
  std::vector<contact::ContactSample> samples;
  source->query(balls.state.view(), samples);
  const contact::QueryStages& s = *source->stages();
  ASSERT_EQ(s.images, 1);
  EXPECT_EQ(s.vertices, balls.a.model.skin.vertices.cols() + balls.b.model.skin.vertices.cols());
  const auto faces = balls.a.model.skin.faces.cols() + balls.b.model.skin.faces.cols();
  EXPECT_GT(s.faces, faces / 50);  // a cap of either ball
  EXPECT_LT(s.faces, faces / 2);   // the other halves face away
  EXPECT_GT(samples.size(), 500u);
  EXPECT_NEAR(static_cast<double>(s.hits), static_cast<double>(samples.size()), static_cast<double>(s.lines));
  EXPECT_GE(s.pairs, s.hits);
  EXPECT_LE(s.pairs, s.pixels);
}

// With twice the pixels along an edge there are four times the samples, on cells of the same nodes: a sample
// more is its place of 32 bytes, and at most as much again for cells that fewer pixels had missed.
TEST_P(QueryWork, ASampleMoreIsItsPlace) {
  const auto held = [](int pixels, double friction) {
    TwoBalls balls;
    contact::ImageOptions options = balls.options();
    options.pixels = pixels;
    options.quadrature_error = 0.0;
    contact::ContactForce term;
    ContactSpec law;
    law.friction = friction;
    term.add_pair(balls.source(false, options), law);
    term.refresh(balls.state.view());
    return std::pair(term.sample_bytes(), static_cast<double>(term.sample_count()));
  };
  const auto [few_bytes, few] = held(128, 0.0);
  const auto [many_bytes, many] = held(256, 0.0);
  EXPECT_NEAR(many, 4.0 * few, 0.1 * many);
  EXPECT_GE(many_bytes - few_bytes, 32.0 * (many - few));
  EXPECT_LT(many_bytes - few_bytes, 64.0 * (many - few));
  // one by one with friction, as it has a direction of its own at each
  const auto [alone_bytes, alone] = held(128, 0.3);
  EXPECT_EQ(alone_bytes, alone * sizeof(contact::ContactSample));
}

// By hand, as query_bytes.cpp derives them: a node has five points of 24 bytes; a face has a number, three
// corners and half a vertex; and so on.
TEST(QueryBytes, AreOfEachThingThatAQueryGoesThrough) {
  EXPECT_EQ(contact::query_bytes({}), 0.0);
  EXPECT_EQ(contact::query_bytes({.nodes = 1.0}), 120.0);
  EXPECT_EQ(contact::query_bytes({.faces = 2.0}), 2.0 * (8.0 + 12.0) + (4.0 + 16.0 + 32.0 + 24.0));
  EXPECT_EQ(contact::query_bytes({.image_vertices = 10.0}), 720.0);
  EXPECT_EQ(contact::query_bytes({.image_faces = 10.0}), 200.0);
  EXPECT_EQ(contact::query_bytes({.pixels = 100.0}), 3200.0);
  EXPECT_EQ(contact::query_bytes({.pairs = 10.0}), 240.0);
  // (u, v), two heights, two times three weights; pixel, two faces and four bytes of padding; area
  EXPECT_EQ(contact::query_bytes({.hits = 1.0}), 2.0 * (4 * 8 + 6 * 8 + 16 + 8));
  EXPECT_EQ(contact::query_bytes({.nodes = 1.0, .sample_bytes = 3200.0}), 3320.0);
}
