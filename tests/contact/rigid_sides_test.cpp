// Rigid surfaces and balls against exact shapes: samples, forces and tangents.
#include <numbers>

#include "palpate/contact/obstacle.h"
#include "rigid_sides.h"

using namespace palpate;
using namespace contact_tests;
using namespace contact_tests::rigid_sides;

// A rigid surface is sampled as a soft one with the same positions and velocities.
TEST(RigidSurface, IsSampledAsASoftOne) {
  std::mt19937 random(4);
  const TriMesh mesh = sphere({0.1, 0.2, -0.1}, 0.6, 10);
  int seen = 0;
  for (const contact::ObstacleEntry& entry : contact::obstacle_registry())
    for (const double look_ahead : {0.0, 0.03, 0.1}) {
      const Pose pose{rotation(random), 0.2 * vector(random)};
      const Twist twist{8.0 * vector(random), 3.0 * vector(random)};
      TriMesh moved = mesh;
      for (Eigen::Index i = 0; i < moved.vertices.cols(); ++i)
        moved.vertices.col(i) = pose * Vec3(mesh.vertices.col(i));
      SurfaceWorld world(moved);
      for (Eigen::Index i = 0; i < moved.vertices.cols(); ++i)
        world.state.u().segment<3>(6 + 3 * i) = twist.at(moved.vertices.col(i) - pose.translation);
      Settings shape;
      for (const PartKey& key : entry.keys)
        shape[key.name] =
            key.required && std::holds_alternative<double>(*key.fallback) ? Setting(0.7) : *key.fallback;
      const auto motion = std::make_shared<contact::TrajectoryFrame>();
      motion->append(0.0, pose, twist);
      const double gap = look_ahead > 0.0 ? 0.01 : 0.0;  // 0: the mean edge
      const auto soft = query(
          *entry.make_source(world.surface, 1, contact::fixed_frame(), shape, gap, look_ahead), world.state);
      const auto rigid = query(*entry.make_source(contact::FrameSurface{mesh, 0, motion}, 1,
                                                  contact::fixed_frame(), shape, gap, look_ahead),
                               world.state);
      ASSERT_EQ(soft.size(), rigid.size()) << entry.name;
      for (std::size_t i = 0; i < soft.size(); ++i) {
        EXPECT_NEAR(soft[i].gap, rigid[i].gap, 1e-14);
        EXPECT_NEAR(soft[i].area, rigid[i].area, 1e-14);
        EXPECT_LT((soft[i].normal - rigid[i].normal).norm(), 1e-13);
        EXPECT_LT((position(soft[i].a, world.state) - pose * rigid[i].a.offset).norm(), 1e-14);
        EXPECT_EQ(rigid[i].a.frame, 0);
        EXPECT_EQ(rigid[i].b.frame, 1);
        ++seen;
      }
    }
  EXPECT_GT(seen, 150);
}

TEST(RigidSurface, CrossingsAreCounted) {
  const dynamics::State state;
  for (const bool ball : {true, false}) {
    const auto motion = std::make_shared<contact::TrajectoryFrame>();
    const TriMesh mesh = sphere(Vec3::Zero(), kR, 6);
    const auto source =
        contact::make_box_source(ball ? contact::ContactSide(contact::FrameBall{kR, Vec3::Zero(), 0, motion})
                                      : contact::ContactSide(contact::FrameSurface{mesh, 0, motion}),
                                 1, contact::fixed_frame(), {}, Vec3(5, 5, 0.1), 0.01);
    for (const double z : {1.0, -1.0, -2.0}) {
      motion->clear();
      motion->append(0.0, {Quat::Identity(), Vec3(0, 0, z)}, {});
      query(*source, state);
    }
    EXPECT_EQ(source->report().tunnelled, ball ? 1 : mesh.vertices.cols());
  }
}

namespace {

/// The tool in the State, pressed into an obstacle: queried, and then moved slightly deeper, so that every
/// sample is pressed throughout a Taylor test.
struct Pressed {
  World world{2, true, 21};
  contact::ContactForce term;

  /// @param held  samples do not follow the state after the query
  Pressed(const contact::ObstacleEntry& entry, bool ball, const ContactSpec& law, bool held = false) {
    const int own = term.add_frame(contact::block_frame(world.body_id)),
              other = term.add_frame(contact::fixed_frame());
    Settings shape;
    for (const PartKey& key : entry.keys)
      shape[key.name] =
          key.required && std::holds_alternative<double>(*key.fallback) ? Setting(0.5) : *key.fallback;
    place(Vec3(0.05, -0.02, 0.3));
    const contact::Nearest nearest = entry.nearest(shape, translation());
    place(translation() + (kR - 0.05 - nearest.gap) * nearest.normal);
    const contact::ContactSide side =
        ball ? contact::ContactSide(
                   contact::FrameBall{kR, Vec3::Zero(), own, contact::block_frame(world.body_id)})
             : contact::ContactSide(
                   contact::FrameSurface{mesh::sphere(kR, 12), own, contact::block_frame(world.body_id)});
    auto source = entry.make_source(side, other, contact::fixed_frame(), shape, 1e-3, 0.0);
    if (held) source = std::make_unique<HeldSource>(std::move(source));
    term.add_pair(std::move(source), law);
    term.refresh(world.state.view());
    place(translation() - 0.02 * nearest.normal);
  }
  Vec3 translation() const { return world.state.q().tail<3>(); }
  void place(const Vec3& p) { world.state.q().tail<3>() = p; }
};

ContactSpec law_of(const char* name, double friction, double onset) {
  ContactSpec law;
  law.law = name;
  law.stiffness_pa_m = 1e3;
  law.damping_pa_s_m = 3.0;
  law.hunt_crossley_s_m = 0.1;
  law.friction = friction;
  law.friction_regularisation_m_s = 50.0;
  law.onset_width_m = onset;
  return law;
}

}  // namespace

TEST(RigidSides, TaylorOfTheirTangents) {
  std::mt19937 random(8);
  int checked = 0;
  for (const contact::ObstacleEntry& entry : contact::obstacle_registry())
    for (const bool ball : {true, false})
      for (const auto& law : {law_of("kelvin_voigt", 0.0, 0.0), law_of("kelvin_voigt", 0.3, 1e-4),
                              law_of("hunt_crossley", 0.3, 0.0)}) {
        Pressed scene(entry, ball, law, true);
        VecX d = VecX::Zero(12);
        for (int i = 6; i < 12; ++i) d[i] = (i < 9 ? 0.3 : 0.1) * uniform(random);
        const VecX f0 = force(scene.term, scene.world.state);
        EXPECT_GT(f0.tail<3>().norm(), 0.1) << entry.name;
        EXPECT_EQ(f0.head<6>().norm(), 0.0);
        const std::string what = entry.name + (ball ? ", ball, " : ", mesh, ") + law.law;
        expect_derivative([&](double h) { return force(scene.term, scene.world.moved(d, h)); },
                          -(step_matrix(scene.term, scene.world.state, 1.0, 0.0).to_dense() * d), 0.02,
                          what.c_str());
        expect_derivative([&](double h) { return force(scene.term, scene.world.pushed(d, h)); },
                          -(step_matrix(scene.term, scene.world.state, 0.0, 1.0).to_dense() * d), 0.05,
                          what.c_str());
        VecX y = VecX::Zero(12);
        const VecX x = VecX::Random(12);
        scene.term.apply_tangent(scene.world.state.view(), 0.7, 0.3, x, y);
        EXPECT_LT((y - step_matrix(scene.term, scene.world.state, 0.7, 0.3).to_dense() * x).norm(),
                  1e-13 * y.norm())
            << what;
        ++checked;
      }
  EXPECT_EQ(checked, 24);
}

// A ball has no moment about its centre, and rotating it changes nothing; when it slides, friction mu N
// opposes it, with the arm from the centre to the patch.
TEST(RigidSides, ABallFeelsNoMomentButThatOfFriction) {
  for (const contact::ObstacleEntry& entry : contact::obstacle_registry()) {
    Pressed smooth(entry, true, law_of("kelvin_voigt", 0.0, 0.0));
    smooth.world.state.u().setZero();
    const VecX f = force(smooth.term, smooth.world.state);
    EXPECT_LT(f.segment<3>(6).norm(), 1e-15) << entry.name;
    VecX rotated = VecX::Zero(12);
    rotated.segment<3>(6) = Vec3(0.4, -0.3, 0.2);
    EXPECT_LT((force(smooth.term, smooth.world.moved(rotated, 1.0)) - f).norm(), 1e-14 * f.norm());

    ContactSpec rough = law_of("kelvin_voigt", 0.3, 0.0);
    rough.friction_regularisation_m_s = 1e-6;
    Pressed sliding(entry, true, rough);
    const Vec3 n = f.tail<3>().normalized(), along = n.unitOrthogonal();
    sliding.world.state.u().setZero();
    sliding.world.state.u().tail<3>() = 0.2 * along;
    const VecX g = force(sliding.term, sliding.world.state);
    EXPECT_LT((g.tail<3>() - f.tail<3>() + 0.3 * f.tail<3>().norm() * along).norm(), 1e-12 * f.norm());
    const Vec3 moment = g.segment<3>(6);
    EXPECT_LT((moment.normalized() - n.cross(along)).norm(), 1e-12) << entry.name;
    const double arm = moment.norm() / (0.3 * f.tail<3>().norm());
    EXPECT_GT(arm, 0.7 * kR) << entry.name;
    EXPECT_LT(arm, kR);
  }
}

// The force between two queries equals the force of a query at that state. A ball that separates and returns
// between queries has zero force and then the same force.
TEST(RigidSides, ABallFollowsTheState) {
  for (const contact::ObstacleEntry& entry : contact::obstacle_registry()) {
    const ContactSpec law = law_of("kelvin_voigt", 0.0, 0.0);
    Pressed fresh(entry, true, law), exact(entry, true, law);
    const Vec3 start = exact.translation(), there = start + Vec3(0.02, -0.03, -0.01);
    for (Pressed* one : {&fresh, &exact}) {
      one->place(there);
      one->world.state.u().setZero();
    }
    fresh.term.refresh(fresh.world.state.view());
    const VecX requested = force(fresh.term, fresh.world.state);
    ASSERT_GT(requested.norm(), 0.1);
    EXPECT_LT((force(exact.term, exact.world.state) - requested).norm(), 1e-10 * requested.norm())
        << entry.name;
    exact.place(start + 5.0 * kR * requested.tail<3>().normalized());
    EXPECT_EQ(force(exact.term, exact.world.state).norm(), 0.0) << entry.name;
    exact.place(there);
    EXPECT_LT((force(exact.term, exact.world.state) - requested).norm(), 1e-10 * requested.norm())
        << entry.name;
    EXPECT_EQ(exact.term.statistics().queries, 1);
  }
}

// A ball flies at a plate: the next query is due when it has penetrated half of the plate's thickness.
TEST(RigidSides, ABallSaysWhenTheNextQueryIsDue) {
  const dynamics::State state;
  const auto asked = [&](double height, double speed, double look_ahead) {
    const auto motion = std::make_shared<contact::TrajectoryFrame>();
    motion->append(0.0, {Quat::Identity(), Vec3(0, 0, 0.01 + kR + height)},
                   {Vec3::Zero(), Vec3(0, 0, speed)});
    const auto source =
        contact::make_box_source(contact::FrameBall{kR, Vec3::Zero(), 0, motion}, 1, contact::fixed_frame(),
                                 {}, Vec3(2, 2, 0.02), 0.01, look_ahead);
    query(*source, state);
    return std::pair(source->report().safe_time, source->report().fast_regions);
  };
  EXPECT_NEAR(asked(0.5, -50.0, 0.01).first, (0.5 + 0.01) / 50.0, 1e-12);
  EXPECT_EQ(asked(0.5, -50.0, 0.01).second, 0);
  EXPECT_EQ(asked(0.5, -50.0, 0.02).second, 1);
  EXPECT_NEAR(asked(-0.004, -50.0, 0.01).first, 0.01 / 50.0, 1e-12) << "in it already: from there";
  EXPECT_EQ(asked(0.5, 50.0, 0.02).first, HUGE_VAL);
}

// With a prescribed tool motion, the State has no force, matrix or event from an obstacle; the wrench on the
// tool is complete.
TEST(RigidSides, AGivenToolFeelsAnObstacleAndTheStateDoesNot) {
  World world(3, false, 4);
  world.state.u().setZero();
  contact::ContactForce term;
  const double depth = 0.05;
  const auto motion = contact::fixed_frame({Quat::Identity(), Vec3(0, 0, kR - depth)});
  const int tool = term.add_frame(motion), floor = term.add_frame(contact::fixed_frame());
  const ContactSpec law = law_of("kelvin_voigt", 0.0, 0.0);
  term.add_pair(contact::make_plane_source(contact::FrameBall{kR, Vec3::Zero(), tool, motion}, floor,
                                           contact::fixed_frame(), Vec3::Zero(), Vec3::UnitZ(), 0.01),
                law);
  term.add_pair(
      std::make_unique<ListSource>(std::vector{on_frame(
          node_point({0}, {1.0}), tool, motion->pose(world.state.view()), {0, 0, 1}, 0.1, 0.2, world.state)}),
      law);
  term.refresh(world.state.view());
  const VecX f = force(term, world.state);
  EXPECT_NEAR(f[2], 1e3 * 0.1 * 0.2, 1e-12);
  EXPECT_EQ(f.tail(6).norm(), 0.0);
  EXPECT_EQ(term.event_count(), 1) << "the node's";
  const double weight = 1e3 * cap(depth);
  EXPECT_NEAR(term.frame_wrench(world.state.view(), tool).force.z(), weight - f[2], 1e-9 * weight);
  EXPECT_GT(term.energy(world.state.view()), 0.5 * 1e3 * 0.1 * 0.1 * 0.2) << "the obstacle's is in it";

  contact::ContactForce alone;
  alone.add_frame(motion);
  alone.add_frame(contact::fixed_frame());
  alone.add_pair(on_plane(contact::FrameSurface{mesh::sphere(kR, 12), 0, motion}, 0.01), law);
  alone.refresh(world.state.view());
  EXPECT_GT(alone.samples().size(), 3u);
  EXPECT_EQ(alone.event_count(), 0) << "of vertices that the State does not move";

  contact::FrameLinearisation all, nodes, frames;
  term.linearise(world.state.view(), tool, all);
  term.linearise(world.state.view(), tool, nodes, contact::Partners::kNodes);
  term.linearise(world.state.view(), tool, frames, contact::Partners::kFrames);
  EXPECT_NEAR(nodes.wrench.force.z(), -f[2], 1e-12);
  EXPECT_NEAR(frames.wrench.force.z(), weight, 1e-9 * weight);
  EXPECT_NEAR(frames.K(5, 5) / (1e3 * std::numbers::pi * (2.0 * kR * depth - depth * depth)), 1.0, 1e-9);
  EXPECT_LT((nodes.K + frames.K - all.K).norm() + (nodes.B + frames.B - all.B).norm(), 1e-12 * all.K.norm());
  EXPECT_LT((nodes.K_body - all.K_body).norm(), 1e-15);
  EXPECT_EQ(all.active, nodes.active + frames.active);
  EXPECT_EQ(nodes.active, 1);
}

TEST(RigidSides, BadOnesAreRefused) {
  EXPECT_THROW(on_plane(contact::FrameBall{kR, Vec3::Zero(), 0, nullptr}, 0.1), InternalError);
  EXPECT_THROW(on_plane(contact::FrameBall{0.0, Vec3::Zero(), 0, contact::fixed_frame()}, 0.1),
               InternalError);
  EXPECT_THROW(on_plane(contact::FrameSurface{mesh::sphere(kR, 4), 0, nullptr}, 0.1), InternalError);
  TriMesh bad = mesh::sphere(kR, 4);
  bad.faces(0, 0) = static_cast<int>(bad.vertices.cols());
  EXPECT_THROW(on_plane(contact::FrameSurface{bad, 0, contact::fixed_frame()}, 0.1), InternalError);
}
