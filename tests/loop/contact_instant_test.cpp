#include "loop/contact_instant.h"

#include <gtest/gtest.h>

#include <cmath>

#include "loop/over_block.h"
#include "loop/small_scenes.h"
#include "palpate/loop/run.h"

using namespace palpate;
using small_scenes::held_block;

namespace {

/// A second, slightly smaller block over the held one, pressed into it by `depth`.
scene::Description two_blocks(double depth, const char* method = "distance") {
  scene::Description d = held_block();
  SoftBodySpec upper = d.bodies[0];
  upper.mesh.size_m = Vec3(0.0275, 0.0315, 0.02);
  upper.position_m = Vec3(0.001, 0.002, 0.03 - depth);
  small_scenes::put_over_block(d, upper);
  d.contacts[0].method = method;
  return d;
}

loop::ContactInstant at_start(loop::World& world) {
  world.contact->keep_views();
  world.contact->refresh(world.state.view());
  return loop::contact_instant(world);
}

}  // namespace

TEST(ContactInstant, BothFacesOfAnOverlapHaveItsDepthAndNothingElseHas) {
  const double depth = 1.2e-3;
  const auto world = loop::assemble(two_blocks(depth));
  const loop::ContactInstant now = at_start(*world);
  ASSERT_EQ(now.depths.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const loop::Body& body = world->bodies[i];
    const Points x = body.surface_points(world->positions(body));
    const double face = i == 0 ? 0.02 : 0.02 - depth;  // height of the face in contact
    int inside = 0;
    for (Eigen::Index v = 0; v < x.cols(); ++v) {
      const bool under =
          std::abs(x(0, v) - 0.001) < 0.0275 / 2 - 1e-6 && std::abs(x(1, v) - 0.002) < 0.0315 / 2 - 1e-6;
      const bool rim = std::abs(std::abs(x(0, v) - 0.001) - 0.0275 / 2) < 1e-6 ||
                       std::abs(std::abs(x(1, v) - 0.002) - 0.0315 / 2) < 1e-6;
      if (rim && std::abs(x(2, v) - face) < 1e-9) continue;  // on the border of the overlap
      if (std::abs(x(2, v) - face) < 1e-9 && under) {
        ++inside;
        EXPECT_NEAR(now.depths[i][v], depth, 1e-6 * depth);
      } else {
        EXPECT_TRUE(std::isnan(now.depths[i][v])) << x.col(v).transpose();
      }
    }
    EXPECT_GE(inside, i == 0 ? 9 : 4);
  }
  EXPECT_TRUE(now.regions.empty());
  EXPECT_TRUE(now.proxies.empty());  // bodies without proxies
  EXPECT_NEAR(now.force_n, 1e6 * depth * 0.0275 * 0.0315, 0.03 * now.force_n);
}

#ifdef PALPATE_HAS_GL
TEST(ContactInstant, AnImageHasAGridOfGaps) {
  const double depth = 1.2e-3;
  const auto world = loop::assemble(two_blocks(depth, "image"));
  const loop::ContactInstant now = at_start(*world);
  ASSERT_EQ(now.regions.size(), 1u);
  EXPECT_NEAR(loop::deepest(now.regions[0]), depth, 1e-6 * depth);
}
#endif

TEST(ContactInstant, OfAnObstacleItIsTheVerticesOwnGaps) {
  scene::Description d = held_block();
  ContactSpec law;
  law.first = "block";
  law.method = "analytic";
  law.stiffness_pa_m = 1e7;
  small_scenes::add_floor(d, law);
  d.obstacles[0].shape["position_m"] = Vec3(0, 0, 5e-4);
  const auto world = loop::assemble(d);
  const loop::ContactInstant now = at_start(*world);
  const loop::Body& body = world->bodies[0];
  const Points x = body.surface_points(world->positions(body));
  int inside = 0;
  for (Eigen::Index v = 0; v < x.cols(); ++v) {
    if (x(2, v) > 1e-9) {
      EXPECT_TRUE(std::isnan(now.depths[0][v]));
    } else {
      EXPECT_NEAR(now.depths[0][v], 5e-4, 1e-12);
      ++inside;
    }
  }
  EXPECT_EQ(inside, 25);
  EXPECT_TRUE(now.regions.empty());
  EXPECT_NEAR(now.force_n, 1e7 * 5e-4 * 0.04 * 0.04, 1e-9);
}

TEST(ContactInstant, ObserversSeeEachQueryAtItsState) {
  struct Watch : loop::Observer {
    std::vector<double> queries, periods;
    bool at_state = true;
    void period(loop::World&, double t) override { periods.push_back(t); }
    void queried(loop::World& world, double t) override {
      queries.push_back(t);
      at_state = at_state && world.state.time() == t;
    }
  } watch;
  scene::Description d = two_blocks(1e-4);
  d.duration_s = 0.03;
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.observers = {&watch};
  const loop::RunResult result = loop::run(*world, options);
  ASSERT_TRUE(result.status.ok());
  EXPECT_EQ(static_cast<long>(watch.queries.size()), result.contact_queries);
  ASSERT_EQ(watch.queries.size(), 3u);
  ASSERT_EQ(watch.periods.size(), 4u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(watch.queries[i], watch.periods[i], 1e-15);
  EXPECT_TRUE(watch.at_state);
  EXPECT_EQ(world->contact->pairs()[0].view, nullptr);  // no observer requests pictures
}
