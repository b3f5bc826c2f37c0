#include "contact/grasp.h"

#include "fixture.h"

// Samples held by a grasp: their forces balance and derive from an energy; derivatives; no force jumps at
// closing.
using namespace contact_tests;

namespace {

constexpr double kDepth = 0.05;

/// Nodes pressed onto a body of the State, each in another direction, with 6 nodes and a body at random
/// velocities.
struct Scene {
  World world{6, true, 21};
  std::shared_ptr<contact::MovingFrame> body = contact::block_frame(world.body_id);
  contact::ContactForce term;
  int frame;
  std::vector<contact::ContactSample> samples;

  explicit Scene(double damping = 0.0, double friction = 0.0, const std::string& law = "kelvin_voigt",
                 bool other_side = true) {
    frame = term.add_frame(body);
    const Pose pose = body->pose(world.state.view());
    const auto tri = node_point({0, 1, 2}, {0.2, 0.9, -0.1}), single = node_point({4}, {1.0});
    samples = {on_frame(tri, frame, pose, {0.1, -0.2, 1}, kDepth, 0.7, world.state),
               on_frame(single, frame, pose, {1, 0.5, -0.3}, kDepth, 0.6, world.state)};
    // a frame as side a, a point that slides on it, and a pair that is apart
    samples.push_back(
        on_frame(node_point({3}, {1.0}), frame, pose, {0.4, 0.5, -0.8}, kDepth, 0.5, world.state));
    if (other_side) {
      std::swap(samples[2].a, samples[2].b);
      samples[2].normal *= -1.0;
    }
    samples[1].b.slide = 0.3 * samples[1].normal;
    samples[1].b.offset -= pose.rotation.conjugate() * samples[1].b.slide;
    samples.push_back(on_frame(node_point({5}, {1.0}), frame, pose, {0, 0, 1}, -0.1, 0.5, world.state));
    ContactSpec spec;
    spec.law = law;
    spec.stiffness_pa_m = 20.0;
    spec.damping_pa_s_m = damping;
    spec.hunt_crossley_s_m = damping;
    spec.friction = friction;
    term.add_pair(std::make_unique<ListSource>(samples), spec);
    term.refresh(world.state.view());
  }

  bool grasp(bool closed = true) {
    term.set_grasp(frame, closed);
    return term.refresh(world.state.view());
  }

  /// The state with the body moved away by `by` and slightly turned: nothing presses if `by` exceeds the
  /// depth.
  dynamics::State pulled(double by) const {
    VecX d = VecX::Zero(world.state.layout().u_size);
    const int at = world.state.layout().find(world.body_id)->u_offset;
    d.segment<3>(at) = Vec3(0.02, -0.03, 0.01);
    for (std::size_t i = 0; i < 3; ++i) {  // each node in its direction, along its normal
      const contact::SurfacePoint& nodes = samples[i].a.frame < 0 ? samples[i].a : samples[i].b;
      const Vec3 away = (samples[i].a.frame < 0 ? by : -by) * samples[i].normal;
      d.segment<3>(3 * nodes.node[static_cast<std::size_t>(nodes.count == 3 ? 1 : 0)]) +=
          away + 0.3 * by * away.cross(Vec3(1, 2, 3)).normalized();
    }
    return world.moved(d, 1.0);
  }
};

dynamics::State at_rest(dynamics::State state) {
  state.u().setZero();
  return state;
}

VecX direction(int size, unsigned seed) {
  std::mt19937 random(seed);
  VecX d(size);
  for (auto& x : d) x = uniform(random);
  return d;
}

/// Sum of forces and of moments about the world's origin.
Wrench total(const VecX& f, const dynamics::State& state, int body_id) {
  Wrench sum;
  for (int i = 0; i < 6; ++i) {
    const Vec3 on_node = f.segment<3>(3 * i);
    sum += {state.view().position(i).cross(on_node), on_node};
  }
  const int at = state.layout().find(body_id)->u_offset;
  const Vec3 force = f.segment<3>(at + 3);
  const Vec3 origin = contact::block_frame(body_id)->pose(state.view()).translation;
  sum += {f.segment<3>(at) + origin.cross(force), force};
  return sum;
}

}  // namespace

TEST(Grasp, NothingJumpsWhereItCloses) {
  for (const char* law : {"kelvin_voigt", "hunt_crossley"}) {
    Scene scene(0.1, 0.3, law);
    const VecX before = force(scene.term, scene.world.state);
    const double energy = scene.term.energy(scene.world.state.view());
    EXPECT_TRUE(scene.grasp());
    EXPECT_EQ(scene.term.statistics().grasps.points, 3) << "what is apart is not held";
    EXPECT_NEAR(scene.term.statistics().grasps.area, 1.8, 1e-12);
    ASSERT_GT(before.norm(), 1.0);
    EXPECT_LE((force(scene.term, scene.world.state) - before).norm(), 1e-13 * before.norm());
    // the damping force at closing is kept as a small deflection along the surface
    EXPECT_GE(scene.term.energy(scene.world.state.view()), energy);
    EXPECT_LE(scene.term.energy(scene.world.state.view()), 1.2 * energy);
  }
}

// Contact never pulls; a grasp does, with the stiffness of contact, until it opens.
TEST(Grasp, HoldsWhatIsPulledAndLetsGo) {
  Scene scene;
  const dynamics::State pulled = at_rest(scene.pulled(3.0 * kDepth));
  EXPECT_EQ(force(scene.term, pulled).norm(), 0.0);
  scene.grasp();
  const VecX f = force(scene.term, pulled);
  const auto& s = scene.samples[1];  // a single node
  const Vec3 on_node = f.segment<3>(12);
  EXPECT_LT(on_node.dot(s.normal), -20.0 * 0.6 * kDepth) << "it is pulled along";
  EXPECT_TRUE(scene.grasp(false));
  EXPECT_EQ(force(scene.term, pulled).norm(), 0.0);
  EXPECT_EQ(scene.term.statistics().grasps.points, 0);
  EXPECT_EQ(scene.term.statistics().grasps.closed, 1);
  EXPECT_GT(scene.term.statistics().grasps.largest_area, 1.7);
}

// Samples that start to press after closing are not held until the grasp closes again; closing where nothing
// presses holds nothing.
TEST(Grasp, ClosesOnWhatPressesThen) {
  Scene scene;
  const dynamics::State pressed = scene.world.state;
  scene.world.state = scene.pulled(3.0 * kDepth);
  EXPECT_FALSE(scene.grasp());
  EXPECT_EQ(scene.term.statistics().grasps.empty, 1);
  scene.world.state = pressed;
  scene.grasp();
  EXPECT_EQ(scene.term.statistics().grasps.points, 0);
  scene.grasp(false);
  scene.grasp();
  EXPECT_EQ(scene.term.statistics().grasps.points, 3);
}

TEST(Grasp, BalancesForceAndMoment) {
  Scene scene(0.1), contact_alone(0.1);  // with points that are no longer opposite each other
  scene.grasp();
  for (const double by : {0.3 * kDepth, 3.0 * kDepth}) {  // still pressing, and pulled apart
    const dynamics::State state = scene.pulled(by);
    const VecX f = force(scene.term, state) - force(contact_alone.term, state);
    ASSERT_GT(f.norm(), 0.1);
    const Wrench sum = total(f, state, scene.world.body_id);
    EXPECT_LE(sum.force.norm(), 1e-13 * f.norm());
    EXPECT_LE(sum.moment.norm(), 1e-13 * f.norm());
  }
}

TEST(Grasp, ForceIsTheEnergysGradient) {
  Scene scene;
  scene.grasp();
  for (const double by : {0.3 * kDepth, 3.0 * kDepth}) {
    const dynamics::State state = at_rest(scene.pulled(by));
    const VecX f = force(scene.term, state);
    for (unsigned seed = 0; seed < 5; ++seed) {
      const VecX d = direction(static_cast<int>(f.size()), seed);
      const double h = 1e-5;
      const auto energy = [&](double step) { return scene.term.energy(moved(state, d, step).view()); };
      EXPECT_NEAR((energy(-h) - energy(h)) / (2.0 * h), f.dot(d), 1e-7 * f.norm() * d.norm());
    }
  }
}

// Without friction and damping of pressing samples, the grasp's damper is the only dissipation.
TEST(Grasp, DamperTakesItsPower) {
  Scene scene(0.1);
  scene.grasp();
  const dynamics::State state = scene.pulled(3.0 * kDepth);
  const VecX damping = force(scene.term, state) - force(scene.term, at_rest(state));
  const double power = scene.term.dissipated_power(state.view());
  ASSERT_GT(power, 0.0);
  EXPECT_NEAR(-damping.dot(state.u()), power, 1e-12 * power);
}

TEST(Grasp, PositionDerivative) {
  Scene scene;
  scene.grasp();
  for (const double by : {0.3 * kDepth, 3.0 * kDepth}) {
    const dynamics::State state = at_rest(scene.pulled(by));
    const VecX d = direction(state.layout().u_size, 3);
    const MatX K = step_matrix(scene.term, state, 1.0, 0.0).to_dense();
    expect_derivative([&](double h) { return force(scene.term, moved(state, d, h)); }, -(K * d), 0.004,
                      by > kDepth ? "pulled" : "pressed");
  }
}

TEST(Grasp, VelocityDerivative) {
  Scene scene(0.1);
  scene.grasp();
  const dynamics::State state = scene.pulled(3.0 * kDepth);
  const VecX d = direction(state.layout().u_size, 4);
  const MatX D = step_matrix(scene.term, state, 0.0, 1.0).to_dense();
  expect_derivative([&](double h) { return force(scene.term, pushed(state, d, h)); }, -(D * d), 0.05, "");
  EXPECT_GT((D * d).norm(), 0.01);
}

TEST(Grasp, ApplyEqualsAssembled) {
  Scene scene(0.1);
  scene.grasp();
  for (const double by : {0.3 * kDepth, 3.0 * kDepth}) {
    const dynamics::State state = scene.pulled(by);
    const VecX x = direction(state.layout().u_size, 5);
    const auto A = step_matrix(scene.term, state, 0.7, 0.3);
    VecX y = VecX::Zero(x.size());
    scene.term.apply_tangent(state.view(), 0.7, 0.3, x, y);
    EXPECT_LT((y - A.to_dense() * x).norm(), 1e-13 * y.norm());
  }
}

// The linearisation for the frame equals the frame's rows and columns of the matrix.
TEST(Grasp, LinearisedForTheFrame) {
  Scene scene(0.1);
  scene.grasp();
  const dynamics::State state = scene.pulled(3.0 * kDepth);
  contact::FrameLinearisation c;
  scene.term.linearise(state.view(), scene.frame, c);
  EXPECT_EQ(c.active, 3);
  const auto K = step_matrix(scene.term, state, 1.0, 0.0), D = step_matrix(scene.term, state, 0.0, 1.0);
  const double size = K.to_dense().norm();
  EXPECT_LE((c.K - K.corner).norm(), 1e-13 * size);
  EXPECT_LE((c.K_body - K.right).norm(), 1e-13 * size);
  EXPECT_LE((c.K_frame - K.bottom).norm(), 1e-13 * size);
  EXPECT_LE((c.B - D.corner).norm(), 1e-13 * size);
  EXPECT_LE((c.B_body - D.right).norm(), 1e-13 * size);
  EXPECT_LE((c.B_frame - D.bottom).norm(), 1e-13 * size);
  const VecX f = force(scene.term, state);
  const int at = state.layout().find(scene.world.body_id)->u_offset;
  Vec6 wrench;
  wrench << c.wrench.moment, c.wrench.force;
  EXPECT_LE((wrench - f.segment<6>(at)).norm(), 1e-13 * f.norm());
  const Wrench alone = scene.term.frame_wrench(state.view(), scene.frame);
  EXPECT_LE((alone.force - c.wrench.force).norm() + (alone.moment - c.wrench.moment).norm(),
            1e-13 * f.norm());
}

// The sums that the interactive solver uses, for a prescribed frame, equal the nodes' block of the matrix.
TEST(Grasp, PointStiffnessIsTheNodesBlock) {
  World world{6, false, 22};
  const auto given = std::make_shared<contact::TrajectoryFrame>();
  const Pose pose{quaternion_of(Vec3(0.3, -0.5, 0.2)), Vec3(0.1, 0.2, -0.4)};
  given->append(0.0, pose, {});
  contact::ContactForce term;
  const int frame = term.add_frame(given);
  const auto tri = node_point({0, 1, 2}, {0.2, 0.9, -0.1});
  ContactSpec spec;
  spec.stiffness_pa_m = 20.0;
  spec.damping_pa_s_m = 0.3;
  term.add_pair(std::make_unique<ListSource>(
                    std::vector{on_frame(tri, frame, pose, {0.1, -0.2, 1}, kDepth, 0.7, world.state)}),
                spec);
  term.set_grasp(frame, true);
  term.refresh(world.state.view());
  VecX away = VecX::Zero(18);
  away.segment<3>(3) = 3.0 * kDepth * Vec3(0.1, -0.2, 1);
  const dynamics::State pulled = world.moved(away, 1.0);
  const VecX shift = direction(18, 6);
  VecX f = VecX::Zero(18);
  dynamics::PointStiffness C;
  dynamics::SparseBorder none;
  term.add_step(pulled.view(), shift, 0.7, 0.3, f, C, none);
  MatX A = MatX::Zero(18, 18);
  for (const auto& point : C.points)
    for (int i = 0; i < point.nodes.count; ++i)
      for (int j = 0; j < point.nodes.count; ++j)
        A.block<3, 3>(3 * point.nodes.node[static_cast<std::size_t>(i)],
                      3 * point.nodes.node[static_cast<std::size_t>(j)]) +=
            point.weight[i] * point.weight[j] * point.C;
  const MatX expected = step_matrix(term, pulled, 0.7, 0.3).to_dense();
  ASSERT_GT(expected.norm(), 1.0);
  EXPECT_LE((A - expected).norm(), 1e-13 * expected.norm());
  const VecX step = force(term, pulled) - step_matrix(term, pulled, 1.0, 0.0).to_dense() * shift;
  EXPECT_LE((f - step).norm(), 1e-13 * step.norm());
}

// A query does not change the resultant of held samples; opening the grasp changes it by all of it.
TEST(Grasp, LettingGoIsAJumpOfTheResultant) {
  Scene scene(0.0, 0.0, "kelvin_voigt", false);
  scene.grasp();
  scene.world.state = at_rest(scene.pulled(3.0 * kDepth));
  scene.grasp();
  EXPECT_LE(scene.term.statistics().refresh_jump.force, 1e-13);
  const double pull = scene.term.frame_wrench(scene.world.state.view(), scene.frame).force.norm();
  scene.grasp(false);
  EXPECT_NEAR(scene.term.statistics().refresh_jump.force, pull, 1e-12 * pull);
}
