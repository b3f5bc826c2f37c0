// A rigid tool with a cavity, pruned as one hull and as the parts made by decompose_solid.
#include <gtest/gtest.h>

#include "palpate/mesh/generators.h"
#include "proxy/decompose.h"
#include "proxy/decompose_solid.h"
#include "pruning.h"
#include "shapes.h"
#include "tools.h"

using namespace palpate;
using namespace pruning;

namespace {

/// A torus around a unit ball whose diameter exceeds the hole's by 2 kPress, so that each point of the ring's
/// inside presses equally.
constexpr double kTube = 0.5, kPress = 0.05, kRing = 1.0 + kTube - kPress, kGap = 0.02;
const TriMesh& ring() {
  static const TriMesh surface = tools::torus(kRing, kTube, 120, 60);
  return surface;
}
/// Upper bound on the distance of the torus's polygons inside of the exact surface.
constexpr double kSag = kRing * 2e-3 + kTube * 2e-3;

LayeredModel ball() {
  LayeredModel model = bumpy_ball(1.0, 0.25, 24, 0.0);
  model.proxies = proxy::decompose(model, {.count = 60});
  return model;
}

LayeredModel block(const Vec3& size, int fine) {
  LayeredModel model;
  model.tets = mesh::box(size, {4, 4, 4});
  const Vec3 cells = fine * size;
  model.skin = mesh::box_surface(
      size, {static_cast<int>(cells.x()), static_cast<int>(cells.y()), static_cast<int>(cells.z())});
  model.embedding = mesh::embed(model.tets, model.skin.vertices);
  model.proxies = proxy::decompose(model, {.count = 40});
  return model;
}

/// Faces with a vertex for which `near` holds.
template <class Near>
std::set<int> near_faces(const TriMesh& skin, const Points& points, const Near& near) {
  std::vector<char> flag;
  for (Eigen::Index v = 0; v < points.cols(); ++v) flag.push_back(near(Vec3(points.col(v))));
  return faces_at(skin.faces, flag);
}

Vec3 middle_of(const TriMesh& skin, const Points& points, int face) {
  return (points.col(skin.faces(0, face)) + points.col(skin.faces(1, face)) +
          points.col(skin.faces(2, face))) /
         3.0;
}

/// A block about the origin, moved, against the fork of tests/proxy/tools.h.
struct Forked {
  LayeredModel model;
  Placed body;
  proxy::ProxySet tool;
  proxy::Pruner pruner;
  Forked(const Vec3& size, const proxy::SolidOptions& options)
      : model(block(size, 10)),
        body(model),
        tool(proxy::rigid_proxies(tools::fork(8), options)),
        pruner(body.set, tool) {}
  std::span<const proxy::ContactRegion> at(const Vec3& place) {
    body.place({Quat::Identity(), place}, 0.0, 0);
    return pruner.query(kGap);
  }
};

/// Signed distance from the fork, exact outside of it: the minimum over its three boxes.
double distance_to_fork(const Vec3& x) {
  const auto box = [&](const Vec3& middle, const Vec3& half) {
    const Vec3 beyond = (x - middle).cwiseAbs() - half;
    return beyond.maxCoeff() <= 0.0 ? beyond.maxCoeff() : beyond.cwiseMax(0.0).norm();
  };
  return std::min({box(Vec3(-1, 0, 1.5), Vec3(0.5, 0.5, 1.5)), box(Vec3(1, 0, 1.5), Vec3(0.5, 0.5, 1.5)),
                   box(Vec3(0, 0, 2.5), Vec3(1.5, 0.5, 0.5))});
}

double share(const std::set<int>& faces, const TriMesh& skin) {
  return static_cast<double>(faces.size()) / static_cast<double>(skin.faces.cols());
}

}  // namespace

// No near face is lost on either side. Each region's normal is local: it is minus the mean radius of the
// region's part of the ball, and its angle at any touching point is explained by the merge angle, the
// width of a proxy, and faces that are near without touching.
TEST(ConcaveTool, ATorusAroundABallTouchesAllAround) {
  const LayeredModel model = ball();
  Placed body(model);
  proxy::ProxySet tool = proxy::rigid_proxies(ring());
  EXPECT_GE(tool.size(), 6);
  proxy::Pruner pruner(body.set, tool);
  // both rotated, so that nothing is aligned
  const Pose pose{Quat(0.9, 0.1, -0.3, 0.2).normalized(), Vec3(0.3, 2.0, -1.0)};
  body.place(pose, 0.0, 0);
  tool.update(pose);
  const auto regions = pruner.query(kGap);
  const Handed found = handed(regions);
  EXPECT_FALSE(found.a_twice);

  const Pose back = pose.inverse();
  const auto from_ring = [&](const Vec3& world) {
    const Vec3 x = back * world;
    return std::hypot(std::hypot(x.x(), x.y()) - kRing, x.z()) - kTube;
  };
  const auto near_a =
      near_faces(model.skin, body.skin, [&](const Vec3& x) { return from_ring(x) < kGap - kSag; });
  const auto near_b =
      near_faces(ring(), ring().vertices, [&](const Vec3& x) { return x.norm() < 1.0 + kGap - 0.01; });
  EXPECT_GT(near_a.size(), 500u);
  EXPECT_GT(near_b.size(), 500u);
  EXPECT_TRUE(holds(found.a, near_a));
  EXPECT_TRUE(holds(found.b, near_b));

  const auto touching =
      near_faces(model.skin, body.skin, [&](const Vec3& x) { return from_ring(x) < -kSag; });
  EXPECT_GE(regions.size(), 3u);  // at most 2 x 60 degrees each
  std::size_t seen = 0;
  for (const auto& region : regions) {
    Vec3 outward = Vec3::Zero();
    double steepest = 1.0;
    for (const int f : region.faces_a) {
      if (!touching.contains(f)) continue;
      const Vec3 radius = (middle_of(model.skin, body.skin, f) - pose.translation).normalized();
      outward += radius;
      steepest = std::min(steepest, -radius.dot(region.region.normal));
      ++seen;
    }
    if (outward.isZero()) continue;
    EXPECT_GT(-outward.normalized().dot(region.region.normal), std::cos(0.15));
    EXPECT_GT(steepest, std::cos(1.05 + 0.3));
  }
  EXPECT_EQ(seen, touching.size());
  RecordProperty("regions", static_cast<int>(regions.size()));

  proxy::ProxySet one = proxy::rigid_proxies(ring(), {.count = 1});
  one.update(pose);
  proxy::Pruner of_one(body.set, one);
  const Handed all = handed(of_one.query(kGap));
  EXPECT_TRUE(holds(all.a, near_a));
  EXPECT_LT(share(found.a, model.skin), 0.6 * share(all.a, model.skin))
      << "one hull closes the hole, and all of the ball's belt is in it";
  RecordProperty("ball_handed_percent_of_parts", static_cast<int>(100 * share(found.a, model.skin)));
  RecordProperty("ball_handed_percent_of_one_hull", static_cast<int>(100 * share(all.a, model.skin)));
  RecordProperty("ball_near_percent", static_cast<int>(100 * share(near_a, model.skin)));
}

// Both prongs on a wide block: the plane is the block's upper face.
TEST(ConcaveTool, AForkStandsOnItsProngs) {
  Forked parts(Vec3(5, 3, 1), {}), one(Vec3(5, 3, 1), {.count = 1});
  const Vec3 place(0, 0, -0.5 + 0.03);
  const auto regions = parts.at(place);
  const Handed found = handed(regions), all = handed(one.at(place));
  const auto near =
      near_faces(parts.model.skin, parts.body.skin, [](const Vec3& x) { return distance_to_fork(x) < kGap; });
  EXPECT_GT(near.size(), 100u);
  EXPECT_TRUE(holds(found.a, near));
  ASSERT_GE(regions.size(), 1u);
  for (const auto& region : regions) EXPECT_LT(region.region.normal.z(), -0.999);
  EXPECT_LE(found.a.size(), all.a.size());
}

// A narrow block in the gap: against the bridge its normal points up, and against a prong to that side. As
// one hull the fork encloses it, and all of its skin is a candidate.
TEST(ConcaveTool, BetweenTheProngsEachWallIsItsOwn) {
  const Vec3 size(0.8, 2.0, 1.6);
  Forked parts(size, {}), one(size, {.count = 1});
  struct {
    Vec3 place, normal;
  } const cases[] = {{Vec3(0, 0, 2.0 - 0.8 + 0.03), -Vec3::UnitZ()},
                     {Vec3(0.13, 0, 1.0), -Vec3::UnitX()},
                     {Vec3(-0.13, 0, 1.0), Vec3::UnitX()}};
  for (const auto& c : cases) {
    const auto regions = parts.at(c.place);
    const Handed found = handed(regions), all = handed(one.at(c.place));
    const auto near = near_faces(parts.model.skin, parts.body.skin,
                                 [](const Vec3& x) { return distance_to_fork(x) < kGap; });
    EXPECT_GT(near.size(), 20u);
    EXPECT_TRUE(holds(found.a, near));
    EXPECT_TRUE(holds(all.a, near));
    EXPECT_FALSE(found.a_twice);
    std::size_t seen = 0;
    for (const auto& region : regions)
      for (const int f : region.faces_a)
        if (distance_to_fork(middle_of(parts.model.skin, parts.body.skin, f)) < -0.01) {
          EXPECT_GT(region.region.normal.dot(c.normal), 0.99) << c.normal.transpose();
          ++seen;
        }
    EXPECT_GT(seen, 10u);
    EXPECT_LT(share(found.a, parts.model.skin), 0.75 * share(all.a, one.model.skin)) << c.normal.transpose();
  }
}
