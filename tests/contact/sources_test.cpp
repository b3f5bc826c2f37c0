#include "surfaces.h"

using namespace contact_tests;

namespace {

Vec3 position_of(const contact::SurfacePoint& p, const dynamics::State& state, const Pose& frame) {
  return p.frame >= 0 ? frame * p.offset : position(p, state);
}

}  // namespace

TEST(PlaneSource, GapsAreDistancesAndAreasSumToTheCap) {
  const Pose pose{quaternion_of(Vec3(0.4, -0.3, 0.8)), Vec3(0.3, -0.2, 0.5)};  // the plane's frame
  const Vec3 point(0.1, 0.2, 0.3), normal(0, 0, 2);                              // scaled on purpose
  const Vec3 n = pose.rotation * Vec3::UnitZ(), origin = pose * point;
  SurfaceWorld world(sphere(origin + 0.6 * n, 1.0, 40));  // centre 0.6 above: depth 0.4
  const auto frame = contact::fixed_frame(pose);
  auto source = contact::make_plane_source(world.surface, 0, frame, point, normal, 0.05);
  std::vector<contact::ContactSample> samples;
  source->query(world.state.view(), samples);
  double area = 0, pressed = 0, candidates = 0;
  for (const auto& s : samples) {
    const Vec3 xa = position_of(s.a, world.state, pose), xb = position_of(s.b, world.state, pose);
    EXPECT_NEAR(s.gap, n.dot(xa - origin), 1e-13);
    EXPECT_NEAR(s.gap, s.normal.dot(xa - xb), 1e-13);
    EXPECT_LT((xa - xb).cross(s.normal).norm(), 1e-13);  // on one line along the normal
    EXPECT_NEAR(n.dot(xb - origin), 0.0, 1e-13);
    EXPECT_GE(s.a.node[0], 2);  // behind the other block's nodes
    EXPECT_LT(s.gap, 0.05);
    (s.gap < 0 ? pressed : candidates) += 1;
    if (s.gap < 0) area += s.area;
  }
  EXPECT_GT(pressed, 100);
  EXPECT_GT(candidates, 10);
  // pi (2 R d - d^2) for the true sphere, d = 0.4; the border is coarse by one row of vertices
  EXPECT_NEAR(area, kPi * (0.8 - 0.16), 0.1);
}

TEST(PlaneSource, CandidateGapComesFromTheMeshWhenNoneIsGiven) {
  SurfaceWorld world(sphere(Vec3(0, 0, 1.01), 1.0, 20));  // 0.01 apart; edges are about 0.15
  auto source = contact::make_plane_source(world.surface, 0, contact::fixed_frame(), Vec3::Zero(), Vec3::UnitZ(), 0.0);
  std::vector<contact::ContactSample> samples;
  source->query(world.state.view(), samples);
  EXPECT_GT(samples.size(), 5u);
  for (const auto& s : samples) EXPECT_GT(s.gap, 0.0);
}

TEST(PlaneSource, VerticesTurnedAwayDoNotPull) {
  SurfaceWorld world(sphere(Vec3(0, 0, -3), 1.0, 12));  // wholly below the plane
  auto source = contact::make_plane_source(world.surface, 0, contact::fixed_frame(), Vec3::Zero(), Vec3::UnitZ(), 0.1);
  std::vector<contact::ContactSample> samples;
  source->query(world.state.view(), samples);
  EXPECT_GT(samples.size(), 50u);
  EXPECT_LT(samples.size(), world.surface.node_of_vertex.size());
  for (const auto& s : samples) EXPECT_GT(s.area, 0.0);
}

TEST(SphereSource, GapsNormalsAndAreas) {
  // A big soft sphere pressed by a small rigid one from above, whose frame is turned and moved.
  SurfaceWorld world(sphere(Vec3::Zero(), 1.0, 60));
  const Pose pose{quaternion_of(Vec3(1, 0.2, -0.4)), Vec3(0.2, 0.1, 0.4)};
  const Vec3 centre = pose.inverse() * Vec3(0.0, 0.0, 1.25);
  auto source = contact::make_sphere_source(world.surface, 0, contact::fixed_frame(pose), centre, 0.3, 0.02);
  std::vector<contact::ContactSample> samples;
  source->query(world.state.view(), samples);
  int pressed = 0;
  for (const auto& s : samples) {
    const Vec3 xa = position_of(s.a, world.state, pose), xb = position_of(s.b, world.state, pose);
    EXPECT_NEAR(s.gap, (xa - Vec3(0, 0, 1.25)).norm() - 0.3, 1e-13);
    EXPECT_LT((s.normal - (xa - Vec3(0, 0, 1.25)).normalized()).norm(), 1e-13);
    EXPECT_NEAR((xb - Vec3(0, 0, 1.25)).norm(), 0.3, 1e-13);
    EXPECT_NEAR(s.gap, s.normal.dot(xa - xb), 1e-13);
    pressed += s.gap < 0;
  }
  EXPECT_GT(pressed, 5);
}

TEST(SphereSource, VertexAtTheCentreStaysFinite) {
  TriMesh one;
  one.vertices.resize(3, 3);
  one.vertices << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  one.faces.resize(3, 1);
  one.faces << 0, 2, 1;  // area vector along -z
  SurfaceWorld world(one);
  auto source = contact::make_sphere_source(world.surface, 0, contact::fixed_frame(), Vec3::Zero(), 0.5, 0.1);
  std::vector<contact::ContactSample> samples;
  source->query(world.state.view(), samples);
  ASSERT_EQ(samples.size(), 1u);  // the others lie outside
  EXPECT_TRUE(samples[0].normal.allFinite());
  EXPECT_NEAR(samples[0].gap, -0.5, 1e-15);
}

TEST(Sources, BadInputIsRefused) {
  SurfaceWorld world(sphere(Vec3::Zero(), 1.0, 4));
  const auto frame = contact::fixed_frame();
  const auto message = [](auto make) {
    try {
      make();
    } catch (const std::exception& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(message([&] { contact::make_plane_source(world.surface, 0, frame, Vec3::Zero(), Vec3::Zero(), 0.1); }).find("has no direction"), std::string::npos);
  EXPECT_NE(message([&] { contact::make_sphere_source(world.surface, 0, frame, Vec3::Zero(), -1.0, 0.1); }).find("radius = -1 must be positive"), std::string::npos);
  EXPECT_NE(message([&] { contact::make_plane_source(world.surface, 0, nullptr, Vec3::Zero(), Vec3::UnitZ(), 0.1); }).find("needs a frame"), std::string::npos);
  EXPECT_NE(message([&] { contact::make_plane_source(world.surface, 0, frame, Vec3::Zero(), Vec3::UnitZ(), -0.1); }).find("must not be negative"), std::string::npos);
  contact::NodeSurface bad = world.surface;
  bad.faces(1, 0) = 1000;
  EXPECT_NE(message([&] { contact::make_plane_source(bad, 0, frame, Vec3::Zero(), Vec3::UnitZ(), 0.1); }).find("names vertex 1000"), std::string::npos);
  world.state.q()[8] = std::nan("");
  auto source = contact::make_plane_source(world.surface, 0, frame, Vec3::Zero(), Vec3::UnitZ(), 0.1);
  std::vector<contact::ContactSample> samples;
  EXPECT_NE(message([&] { source->query(world.state.view(), samples); }).find("not finite"), std::string::npos);
}
