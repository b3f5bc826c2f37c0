// Samples of a soft surface against exact shapes: gaps, normals, areas and skins; refusals of bad input.
#include "surfaces.h"

using namespace contact_tests;

namespace {

Vec3 position_of(const contact::SurfacePoint& p, const dynamics::State& state, const Pose& frame) {
  return p.frame >= 0 ? Vec3(frame * p.offset + p.slide) : position(p, state);
}

}  // namespace

TEST(PlaneSource, GapsAreDistancesAndAreasSumToTheCap) {
  const Pose pose{quaternion_of(Vec3(0.4, -0.3, 0.8)), Vec3(0.3, -0.2, 0.5)};  // the plane's frame
  const Vec3 point(0.1, 0.2, 0.3), normal(0, 0, 2);                            // not normalised, on purpose
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
    EXPECT_GE(s.a.node[0], 2);  // after the other block's nodes
    EXPECT_LT(s.gap, 0.05);
    (s.gap < 0 ? pressed : candidates) += 1;
    if (s.gap < 0) area += s.area;
  }
  EXPECT_GT(pressed, 100);
  EXPECT_GT(candidates, 10);
  // pi (2 R d - d^2) for the exact sphere, d = 0.4; the border is resolved to one row of vertices
  EXPECT_NEAR(area, kPi * (0.8 - 0.16), 0.1);
}

TEST(PlaneSource, CandidateGapComesFromTheMeshWhenNoneIsGiven) {
  SurfaceWorld world(sphere(Vec3(0, 0, 1.01), 1.0, 20));  // 0.01 apart; edges are about 0.15
  auto source =
      contact::make_plane_source(world.surface, 0, contact::fixed_frame(), Vec3::Zero(), Vec3::UnitZ(), 0.0);
  std::vector<contact::ContactSample> samples;
  source->query(world.state.view(), samples);
  EXPECT_GT(samples.size(), 5u);
  for (const auto& s : samples) EXPECT_GT(s.gap, 0.0);
}

TEST(PlaneSource, VerticesThatFaceAwayDoNotPull) {
  SurfaceWorld world(sphere(Vec3(0, 0, -3), 1.0, 12));  // entirely below the plane
  auto source =
      contact::make_plane_source(world.surface, 0, contact::fixed_frame(), Vec3::Zero(), Vec3::UnitZ(), 0.1);
  std::vector<contact::ContactSample> samples;
  source->query(world.state.view(), samples);
  EXPECT_GT(samples.size(), 50u);
  EXPECT_LT(samples.size(), world.surface.node_of_vertex.size());
  for (const auto& s : samples) EXPECT_GT(s.area, 0.0);
}

TEST(SphereSource, GapsNormalsAndAreas) {
  // A large soft sphere pressed from above by a small rigid one, whose frame is rotated and moved.
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
  ASSERT_EQ(samples.size(), 1u);  // the others are outside
  EXPECT_TRUE(samples[0].normal.allFinite());
  EXPECT_NEAR(samples[0].gap, -0.5, 1e-15);
}

namespace {

/// Distance to a solid by brute force: the minimum over a fine grid of its surface, with the sign of
/// `inside`.
template <class Surface>
double sampled_distance(const Vec3& x, bool inside, const Surface& surface) {
  double least = 1e30;
  surface([&](const Vec3& p) { least = std::min(least, (x - p).norm()); });
  return inside ? -least : least;
}

/// Random points as a soft surface: areas are not meaningful, so that only gaps are tested.
TriMesh scattered(int count, double reach, const Vec3& toward) {
  std::mt19937 random(5);
  TriMesh mesh;
  mesh.vertices.resize(3, 3 * count);
  mesh.faces.resize(3, count);
  for (int i = 0; i < count; ++i) {
    const Vec3 x = reach * vector(random), side = toward.unitOrthogonal(), other = toward.cross(side);
    mesh.vertices.col(3 * i) = x;
    mesh.vertices.col(3 * i + 1) = x + 1e-3 * side;
    mesh.vertices.col(3 * i + 2) = x + 1e-3 * other;
    mesh.faces.col(i) << 3 * i, 3 * i + 1, 3 * i + 2;
  }
  return mesh;
}

/// Checks every sample: a's gap is the distance to the solid, b lies on its surface, the normal is the gap's
/// gradient.
template <class Surface, class Inside>
int check_solid(contact::SampleSource& source, const SurfaceWorld& world, const Pose& frame,
                const Pose& place, Surface surface, Inside inside, double grid) {
  std::vector<contact::ContactSample> samples;
  source.query(world.state.view(), samples);
  for (const auto& s : samples) {
    const Vec3 xa = position_of(s.a, world.state, frame), xb = position_of(s.b, world.state, frame),
               local = (frame * place).inverse() * xa;
    EXPECT_NEAR(s.gap, sampled_distance(local, inside(local), surface), grid) << local.transpose();
    EXPECT_NEAR(s.gap, s.normal.dot(xa - xb), 1e-12);
    EXPECT_NEAR(s.normal.norm(), 1.0, 1e-12);
    EXPECT_LT((xa - xb).cross(s.normal).norm(), 1e-12);
    EXPECT_LT(std::abs(sampled_distance((frame * place).inverse() * xb, false, surface)), grid)
        << "b is on the surface";
  }
  return static_cast<int>(samples.size());
}

}  // namespace

TEST(BoxSource, GapsAreDistances) {
  const Pose frame{quaternion_of(Vec3(0.4, -0.3, 0.8)), Vec3(0.3, -0.2, 0.5)},
      place{quaternion_of(Vec3(-0.2, 0.7, 0.1)), Vec3(0.1, 0.2, -0.1)};
  const Vec3 half(0.3, 0.5, 0.2);
  const auto surface = [&](auto visit) {
    constexpr int n = 40;
    for (int axis = 0; axis < 3; ++axis)
      for (int side : {-1, 1})
        for (int i = 0; i <= n; ++i)
          for (int j = 0; j <= n; ++j) {
            Vec3 p;
            p[axis] = side * half[axis];
            p[(axis + 1) % 3] = half[(axis + 1) % 3] * (2.0 * i / n - 1.0);
            p[(axis + 2) % 3] = half[(axis + 2) % 3] * (2.0 * j / n - 1.0);
            visit(p);
          }
  };
  int seen = 0;
  for (const Vec3& toward :
       {Vec3(Vec3::UnitX()), Vec3(-Vec3::UnitX()), Vec3(Vec3::UnitZ()), Vec3(-Vec3::UnitZ())}) {
    SurfaceWorld world(scattered(60, 0.9, toward));
    auto source =
        contact::make_box_source(world.surface, 0, contact::fixed_frame(frame), place, 2.0 * half, 2.0);
    seen += check_solid(
        *source, world, frame, place, surface,
        [&](const Vec3& x) { return (x.cwiseAbs().array() <= half.array()).all(); }, 0.02);
  }
  EXPECT_GT(seen, 200);
}

TEST(CylinderSource, GapsAreDistances) {
  const Pose frame{quaternion_of(Vec3(0.4, -0.3, 0.8)), Vec3(0.3, -0.2, 0.5)},
      place{quaternion_of(Vec3(-0.2, 0.7, 0.1)), Vec3(0.1, 0.2, -0.1)};
  const double radius = 0.3, half = 0.4;
  const auto surface = [&](auto visit) {
    constexpr int n = 120;
    for (int i = 0; i < n; ++i) {
      const double phi = 2 * kPi * i / n, c = std::cos(phi), s = std::sin(phi);
      for (int j = 0; j <= 40; ++j) {
        visit(Vec3(radius * c, radius * s, half * (j / 20.0 - 1.0)));
        for (int side : {-1, 1}) visit(Vec3(radius * c * j / 40.0, radius * s * j / 40.0, side * half));
      }
    }
  };
  int seen = 0;
  for (const Vec3& toward :
       {Vec3(Vec3::UnitX()), Vec3(-Vec3::UnitX()), Vec3(Vec3::UnitZ()), Vec3(-Vec3::UnitZ())}) {
    SurfaceWorld world(scattered(60, 0.9, toward));
    auto source = contact::make_cylinder_source(world.surface, 0, contact::fixed_frame(frame), place, radius,
                                                2 * half, 2.0);
    seen += check_solid(
        *source, world, frame, place, surface,
        [&](const Vec3& x) { return std::hypot(x.x(), x.y()) <= radius && std::abs(x.z()) <= half; }, 0.02);
  }
  EXPECT_GT(seen, 200);
}

// A round surface that rotates about its centre or axis does not move: force and gap must not change between
// two queries, and it must not cause a moment.
TEST(RoundSources, RotationAboutTheCentreChangesNothing) {
  const Pose start{quaternion_of(Vec3(0.4, -0.3, 0.8)), Vec3(0.3, -0.2, 0.5)};
  const Vec3 axis = start.rotation * Vec3::UnitZ();
  const auto above = scattered(60, 0.3, Vec3::UnitX());
  int pressed = 0;
  for (const bool round : {true, false}) {
    SurfaceWorld world(above);
    auto motion = std::make_shared<contact::TrajectoryFrame>();
    motion->append(0.0, start, {});
    contact::ContactForce term;
    const int frame = term.add_frame(motion);
    ContactSpec law;
    law.stiffness_pa_m = 1e9;
    term.add_pair(round ? contact::make_sphere_source(world.surface, frame, motion, Vec3::Zero(), 0.7, 0.1)
                        : contact::make_cylinder_source(world.surface, frame, motion, {}, 0.7, 9.0, 0.1),
                  law);
    term.refresh(world.state.view());
    const Wrench before = term.frame_wrench(world.state.view(), frame);
    const double energy = term.energy(world.state.view()), size = 0.7 * before.force.norm();
    ASSERT_GT(before.force.norm(), 1.0);
    for (const double angle : {1e-3, 0.7, 3.0}) {
      const Vec3 about = round ? Vec3(Vec3(1, -2, 0.5).normalized()) : axis;
      motion->clear();
      motion->append(0.0, {quaternion_of(angle * about) * start.rotation, start.translation}, {});
      const Wrench after = term.frame_wrench(world.state.view(), frame);
      contact::FrameLinearisation seen;
      term.linearise(world.state.view(), frame, seen);
      EXPECT_LT((after.force - before.force).norm(), 1e-12 * before.force.norm()) << angle;
      EXPECT_NEAR(term.energy(world.state.view()), energy, 1e-12 * energy) << angle;
      EXPECT_LT(std::abs(about.dot(after.moment)), 1e-12 * size) << angle;
      EXPECT_LT((seen.K.leftCols<3>() * about).norm(), 1e-12 * seen.K.rightCols<3>().norm())
          << "nor may a linearisation say that it would";
      EXPECT_LT((seen.geometric * about).norm(), 1e-12 * size) << angle;
      ++pressed;
    }
  }
  EXPECT_EQ(pressed, 6);
}

// The vertices of a skin give the same samples as nodes at their positions.
TEST(Skins, VerticesActAsNodesInTheirPlaces) {
  SkinWorld skin;
  SurfaceWorld nodes({skin.vertices, skin.skin.faces});
  std::vector<contact::ContactSample> of_skin, of_nodes;
  const Vec3 point(0, 0, -0.6), normal(0.1, 0.2, 1.0);
  contact::make_plane_source(skin.surface, 0, contact::fixed_frame(), point, normal, 0.05)
      ->query(skin.state.view(), of_skin);
  contact::make_plane_source(nodes.surface, 0, contact::fixed_frame(), point, normal, 0.05)
      ->query(nodes.state.view(), of_nodes);
  ASSERT_EQ(of_skin.size(), of_nodes.size());
  EXPECT_GT(of_skin.size(), 50u);
  int extrapolated = 0;
  for (std::size_t i = 0; i < of_skin.size(); ++i) {
    EXPECT_NEAR(of_skin[i].gap, of_nodes[i].gap, 1e-14);
    EXPECT_NEAR(of_skin[i].area, of_nodes[i].area, 1e-14);
    EXPECT_LT(
        (point_on_nodes(of_skin[i].a, skin.state.view()) - point_on_nodes(of_nodes[i].a, nodes.state.view()))
            .norm(),
        1e-14);
    extrapolated += *std::min_element(of_skin[i].a.weight.begin(), of_skin[i].a.weight.end()) < -1e-9;
  }
  EXPECT_GT(extrapolated, 5) << "the skin stands out between the ball's flat faces";
}

// Look-ahead uses the skin's velocity: all nodes move down at 2 m/s, which in 0.1 s is 0.2 m.
TEST(Skins, VelocityIsThatOfTheSkin) {
  SkinWorld skin;
  for (Eigen::Index i = 6; i < skin.state.u().size(); ++i) skin.state.u()[i] = i % 3 == 2 ? -2.0 : 0.0;
  const double lowest = skin.vertices.row(2).minCoeff();
  auto source = contact::make_plane_source(skin.surface, 0, contact::fixed_frame(), Vec3(0, 0, lowest - 0.3),
                                           Vec3::UnitZ(), 0.15, 0.1);
  std::vector<contact::ContactSample> samples;
  source->query(skin.state.view(), samples);
  int expected = 0;
  for (const auto& x : skin.vertices.colwise()) expected += x.z() - (lowest - 0.3) < 0.35 - 1e-12;
  EXPECT_EQ(static_cast<int>(samples.size()), expected);
  EXPECT_GT(expected, 3);
}

TEST(Skins, BadEmbeddingsAreRefused) {
  SkinWorld skin;
  contact::NodeSurface bad = skin.surface;
  bad.embedding.tet[5] = static_cast<int>(skin.ball.tets.cols());
  EXPECT_THROW(contact::make_plane_source(bad, 0, contact::fixed_frame(), Vec3::Zero(), Vec3::UnitZ(), 0.1),
               InternalError);
  bad = skin.surface;
  bad.embedding.weights.conservativeResize(4, 3);
  EXPECT_THROW(contact::make_plane_source(bad, 0, contact::fixed_frame(), Vec3::Zero(), Vec3::UnitZ(), 0.1),
               InternalError);
}

TEST(Sources, BadInputIsRefused) {
  SurfaceWorld world(sphere(Vec3::Zero(), 1.0, 4));
  const auto frame = contact::fixed_frame();
  const auto message = [](auto make) {
    try {
      make();
    } catch (const std::exception& e) { return std::string(e.what()); }
    return std::string();
  };
  EXPECT_NE(message([&] {
              contact::make_plane_source(world.surface, 0, frame, Vec3::Zero(), Vec3::Zero(), 0.1);
            }).find("has no direction"),
            std::string::npos);
  EXPECT_NE(message([&] {
              contact::make_sphere_source(world.surface, 0, frame, Vec3::Zero(), -1.0, 0.1);
            }).find("radius = -1 must be positive"),
            std::string::npos);
  EXPECT_NE(message([&] {
              contact::make_box_source(world.surface, 0, frame, {}, Vec3(1, 0, 1), 0.1);
            }).find("must be positive"),
            std::string::npos);
  EXPECT_NE(message([&] {
              contact::make_cylinder_source(world.surface, 0, frame, {}, 1.0, -2.0, 0.1);
            }).find("length = -2 must be positive"),
            std::string::npos);
  EXPECT_NE(message([&] {
              contact::make_plane_source(world.surface, 0, nullptr, Vec3::Zero(), Vec3::UnitZ(), 0.1);
            }).find("needs a frame"),
            std::string::npos);
  EXPECT_NE(message([&] {
              contact::make_plane_source(world.surface, 0, frame, Vec3::Zero(), Vec3::UnitZ(), -0.1);
            }).find("must not be negative"),
            std::string::npos);
  contact::NodeSurface bad = world.surface;
  bad.faces(1, 0) = 1000;
  EXPECT_NE(message([&] {
              contact::make_plane_source(bad, 0, frame, Vec3::Zero(), Vec3::UnitZ(), 0.1);
            }).find("refers to vertex 1000"),
            std::string::npos);
  world.state.q()[8] = std::nan("");
  auto source = contact::make_plane_source(world.surface, 0, frame, Vec3::Zero(), Vec3::UnitZ(), 0.1);
  std::vector<contact::ContactSample> samples;
  EXPECT_NE(message([&] { source->query(world.state.view(), samples); }).find("not finite"),
            std::string::npos);
}
