// Data that a query sends to the GPU, and reuse between queries.
#include "contact/gpu_image.h"

#include <numeric>

#include "contact/image_region.h"
#include "two_balls.h"

using namespace contact_tests;

namespace {

std::vector<int> all_faces(const contact::ImageSide& side) {
  std::vector<int> out(static_cast<std::size_t>(side.faces().cols()));
  std::iota(out.begin(), out.end(), 0);
  return out;
}

/// Two sides and one image of them along the line between two points.
struct Look {
  contact::RegionContext context;
  contact::ImageRegion region{context};
  std::vector<int> faces_a, faces_b;

  Look(std::shared_ptr<contact::ImageSide> a, std::shared_ptr<contact::ImageSide> b)
      : faces_a(all_faces(*a)), faces_b(all_faces(*b)) {
    context.a = std::move(a);
    context.b = std::move(b);
    context.options = image_options(96, 0.02);
  }
  void update(const dynamics::State& state) {
    context.a->update(state.view());
    context.b->update(state.view());
  }
  std::size_t pairs_in(contact::DepthImage& image, const Vec3& origin, const Vec3& normal) {
    region.start({origin, normal.normalized(), 0.02, &faces_a, &faces_b});
    contact::DepthRequest* request = region.requested();
    if (!request) return 0;
    image.answer({&request, 1});
    return request->pairs.size();
  }
};

std::size_t bytes(Eigen::Index points) { return 16 * static_cast<std::size_t>(points); }

}  // namespace

// Skins are not sent: a query sends the nodes of each soft body, once for all pairs, and a rigid surface is
// sent only once.
TEST(GpuImages, AQuerySendsNodesAlone) {
  TwoBalls balls;
  const TriMesh tool = sphere(Vec3(-0.3, 0.6, 1.2), 0.5, 20);
  const auto a = std::shared_ptr(contact::soft_side(balls.a.surface)),
             b = std::shared_ptr(contact::soft_side(balls.b.surface)),
             c = std::shared_ptr(contact::rigid_side(tool, 0, contact::fixed_frame()));
  Look soft(a, b), rigid(a, c);
  contact::GpuImage image;
  const auto query = [&] {
    soft.update(balls.state);
    rigid.update(balls.state);
    image.start_query();
    EXPECT_GT(soft.pairs_in(image, Vec3(0.17, -0.1, -0.9), Vec3(-0.35, 0.2, 1.95)), 500u);
    EXPECT_GT(rigid.pairs_in(image, Vec3(-0.2, 0.4, 0.8), Vec3(0.3, -0.6, -1.2)), 100u);
  };
  soft.update(balls.state);
  rigid.update(balls.state);
  image.prepare(*a, *b);
  image.prepare(*a, *c);
  query();
  EXPECT_FALSE(contact::gpu_device().name.empty());
  EXPECT_NE(contact::gpu_device().driver.find("4."), std::string::npos);
  const std::size_t nodes = bytes(balls.a.model.tets.nodes.cols() + balls.b.model.tets.nodes.cols()),
                    first = image.surfaces().sent_bytes();
  EXPECT_GE(first, 2 * nodes + bytes(tool.vertices.cols())) << "once to prepare, once in the query";
  query();
  EXPECT_EQ(image.surfaces().sent_bytes() - first, nodes);
  EXPECT_EQ(image.surfaces().size(), 3u);
}

// Everything that the first touch needs (context, programs, both surfaces) is created by a query in which
// nothing touches. Created at first touch, it would delay that query by a tenth of a second.
TEST(GpuImages, TheFirstQueryMakesAllThatFirstTouchNeeds) {
  TwoBalls balls;
  const VecX touching = balls.state.q();
  balls.state.q().head(3 * balls.a.model.tets.nodes.cols()).array() += 10.0;
  const auto source = balls.source(true);
  std::vector<contact::ContactSample> samples;
  source->query(balls.state.view(), samples);
  EXPECT_EQ(source->report().stages->images, 0);
  const double prepared = source->report().stages->images_s;
  EXPECT_GT(prepared, 0.0);
  EXPECT_FALSE(contact::gpu_device().name.empty());
  balls.state.q() = touching;
  source->query(balls.state.view(), samples);
  EXPECT_GT(source->report().stages->images, 0);
  EXPECT_GT(samples.size(), 40u);
}

// Single-precision positions are relative to the body, not to the world's origin: wherever the bodies are,
// the same vertices have the same gaps, to the rounding of positions.
TEST(GpuImages, SeeTheSameFarFromTheOrigin) {
  for (const bool pruned : {false, true}) {
    std::vector<contact::ContactSample> near, far;
    for (const double away : {0.0, 1e5}) {
      TwoBalls balls;
      balls.state.q().array() += away;
      balls.source(pruned)->query(balls.state.view(), away == 0.0 ? near : far);
    }
    ASSERT_GT(near.size(), 40u);
    ASSERT_EQ(far.size(), near.size());
    for (std::size_t i = 0; i < near.size(); ++i) {
      EXPECT_NEAR(far[i].gap, near[i].gap, 1e-8) << i;
      EXPECT_EQ(far[i].a.node, near[i].a.node) << i;
    }
  }
}
