#include <Eigen/Eigenvalues>

#include "fixture.h"
#include "palpate/core/error.h"

using namespace contact_tests;

namespace {

struct Law {
  const char* name;
  double friction, regularisation;
};

/// Sufficiently deep contacts of every kind: nodes on a prescribed frame, nodes on a body of the State, nodes
/// on nodes, body on a prescribed frame. Depths of 0.4 at speeds of order 1 keep every sample pressed
/// throughout a Taylor test.
struct Scene {
  /// Moves a sample's point to a round surface whose centre is 0.6 deeper: that part of its arm does not
  /// rotate with the frame.
  static contact::ContactSample rounded(contact::ContactSample s, const Pose& frame) {
    s.b.slide = 0.6 * s.normal;
    s.b.offset -= frame.rotation.conjugate() * s.b.slide;
    return s;
  }

  World world{6, true, 11};
  std::shared_ptr<contact::TrajectoryFrame> given = std::make_shared<contact::TrajectoryFrame>();
  Pose given_pose{quaternion_of(Vec3(0.3, -0.5, 0.2)), Vec3(0.1, 0.2, -0.4)};
  Twist given_twist{Vec3(0.4, 0.2, -0.7), Vec3(-0.3, 0.5, 0.1)};
  contact::ContactForce term;

  explicit Scene(const Law& law, bool with_given = true,
                 FrictionTangent friction_tangent = FrictionTangent::kFull) {
    given->append(0.0, given_pose, given_twist);
    const auto body = contact::block_frame(world.body_id);
    const int given_index = term.add_frame(given), body_index = term.add_frame(body);
    const auto view = world.state.view();
    const Pose body_pose = body->pose(view);
    std::vector<contact::ContactSample> samples;
    const auto tri = node_point({0, 1, 2}, {0.2, 0.9, -0.1}), single = node_point({4}, {1.0});
    if (with_given)
      samples.push_back(on_frame(tri, given_index, given_pose, {0.1, -0.2, 1}, 0.4, 0.7, world.state));
    samples.push_back(on_frame(single, body_index, body_pose, {1, 0.5, -0.3}, 0.5, 0.6, world.state));
    samples.push_back(
        rounded(on_frame(single, body_index, body_pose, {0.4, 0.5, -0.8}, 0.5, 0.6, world.state), body_pose));
    if (with_given)
      samples.push_back(rounded(
          on_frame(single, given_index, given_pose, {0.3, -0.6, 0.8}, 0.4, 0.7, world.state), given_pose));
    samples.push_back(
        on_nodes(tri, node_point({3, 4, 5}, {0.3, 0.3, 0.4}), {-0.3, 1, 0.2}, 0.45, 0.5, world.state));
    if (with_given) {  // a: the body, b: the prescribed frame
      contact::ContactSample s;
      s.a.frame = body_index;
      s.a.offset = Vec3(0.2, -0.1, 0.3);
      s.b.frame = given_index;
      s.normal = Vec3(0.2, 0.1, -1).normalized();
      s.b.offset = given_pose.inverse() * Vec3(body_pose * s.a.offset + 0.4 * s.normal);
      s.area = 0.8;
      samples.push_back(s);
    }
    ContactSpec spec;
    spec.law = law.name;
    spec.stiffness_pa_m = 20.0;
    spec.damping_pa_s_m = 0.3;
    spec.hunt_crossley_s_m = 0.05;
    spec.friction = law.friction;
    spec.friction_regularisation_m_s = law.regularisation;
    spec.friction_tangent = friction_tangent;
    term.add_pair(std::make_unique<ListSource>(samples), spec);
    term.refresh(world.state.view());
  }
};

const Law kLaws[] = {{"kelvin_voigt", 0.0, 1.0},
                     {"hunt_crossley", 0.0, 1.0},
                     {"kelvin_voigt", 0.4, 1e-3},
                     {"hunt_crossley", 0.4, 100.0}};

VecX direction(int size, unsigned seed) {
  std::mt19937 random(seed);
  VecX d(size);
  for (auto& x : d) x = uniform(random);
  return d;
}

}  // namespace

TEST(ContactTangent, PositionDerivative) {
  for (const Law& law : kLaws) {
    Scene scene(law);
    const VecX d = direction(scene.world.state.layout().u_size, 3);
    const MatX K = step_matrix(scene.term, scene.world.state, 1.0, 0.0).to_dense();
    expect_derivative([&](double h) { return force(scene.term, scene.world.moved(d, h)); }, -(K * d), 0.02,
                      law.name);
  }
}

TEST(ContactTangent, VelocityDerivative) {
  for (const Law& law : kLaws) {
    Scene scene(law);
    const VecX d = direction(scene.world.state.layout().u_size, 4);
    const MatX D = step_matrix(scene.term, scene.world.state, 0.0, 1.0).to_dense();
    expect_derivative([&](double h) { return force(scene.term, scene.world.pushed(d, h)); }, -(D * d), 0.05,
                      law.name);
  }
}

TEST(ContactTangent, ApplyEqualsAssembled) {
  for (const Law& law : kLaws) {
    Scene scene(law);
    const VecX x = direction(scene.world.state.layout().u_size, 5);
    const auto A = step_matrix(scene.term, scene.world.state, 0.7, 0.3);
    VecX y = VecX::Zero(x.size());
    scene.term.apply_tangent(scene.world.state.view(), 0.7, 0.3, x, y);
    EXPECT_LT((y - A.to_dense() * x).norm(), 1e-13 * y.norm()) << law.name;
  }
}

// Without friction the blocks between nodes are symmetric, and positive semi-definite where the spring acts.
TEST(ContactTangent, NodePartIsSymmetricWithoutFriction) {
  Scene scene(kLaws[0]);
  const MatX A = step_matrix(scene.term, scene.world.state, 1.0, 0.5).to_dense().topLeftCorner(18, 18);
  EXPECT_GT(A.norm(), 1.0);
  EXPECT_LT((A - A.transpose()).norm(), 1e-14 * A.norm());
}

// The symmetric tangent is symmetric and positive semi-definite, and differs much from the full one;
// assembled and applied forms agree; forces are unchanged.
TEST(ContactTangent, SymmetricOneIsPositiveAndChangesNoForce) {
  for (const Law& law : {kLaws[2], kLaws[3]}) {
    Scene scene(law, true, FrictionTangent::kSymmetric), full(law);
    const auto nodes = [](Scene& of, double k, double d) {
      return MatX(step_matrix(of.term, of.world.state, k, d).to_dense().topLeftCorner(18, 18));
    };
    for (const auto& [k, d] : {std::pair{1.0, 0.0}, std::pair{0.0, 1.0}, std::pair{0.7, 0.3}}) {
      const MatX A = nodes(scene, k, d), whole = nodes(full, k, d);
      EXPECT_GT((whole - whole.transpose()).norm(), 1e-3 * whole.norm()) << law.name;
      EXPECT_LT((A - A.transpose()).norm(), 1e-14 * A.norm()) << law.name;
      const Eigen::SelfAdjointEigenSolver<MatX> eigen(A);
      EXPECT_GT(eigen.eigenvalues().minCoeff(), -1e-13 * eigen.eigenvalues().maxCoeff()) << law.name;
      EXPECT_GT((whole - A).norm(), 1e-3 * whole.norm()) << law.name;
    }
    const VecX x = direction(scene.world.state.layout().u_size, 5);
    VecX y = VecX::Zero(x.size());
    scene.term.apply_tangent(scene.world.state.view(), 0.7, 0.3, x, y);
    EXPECT_LT((y - step_matrix(scene.term, scene.world.state, 0.7, 0.3).to_dense() * x).norm(),
              1e-13 * y.norm())
        << law.name;
    EXPECT_EQ(force(scene.term, scene.world.state), force(full.term, full.world.state)) << "forces are whole";
  }
}

// A sliding node is pressed deeper by e after the tangent was formed: the friction that the step left out is
// mu A k e, relative to mu A k depth.
TEST(ContactTangent, TheFrictionLeftOutIsMeasured) {
  World world(2, false, 3);
  world.state.u().setZero();
  world.state.u().head<3>() = Vec3(0.5, 0, 0);
  contact::ContactForce term;
  const int frame = term.add_frame(contact::fixed_frame());
  ContactSpec spec;
  spec.stiffness_pa_m = 2e3;
  spec.friction = 0.3;
  spec.friction_tangent = FrictionTangent::kSymmetric;
  constexpr double depth = 0.02, deeper = 0.005, area = 0.7;
  term.add_pair(std::make_unique<ListSource>(std::vector<contact::ContactSample>{
                    on_frame(node_point({0}, {1.0}), frame, Pose{}, {0, 0, 1}, depth, area, world.state)}),
                spec);
  term.refresh(world.state.view());
  EXPECT_TRUE(term.traits().symmetric_tangent);
  // the spring along z and friction's damper across the sliding direction, without coupling
  const MatX A = step_matrix(term, world.state, 1.0, 1.0).to_dense().topLeftCorner(3, 3);
  const double pressing = area * 2e3 * depth;
  EXPECT_LT((A - MatX(Vec3(0.0, 0.3 * pressing / 0.5, area * 2e3).asDiagonal())).norm(), 1e-12 * A.norm())
      << A;
  EXPECT_NEAR(term.statistics().largest_lagged_friction, 0.3 * area * 2e3 * depth, 1e-12);
  EXPECT_EQ(term.statistics().largest_friction_lag, 0.0);
  world.state.q()[2] -= deeper;
  term.refresh(world.state.view());
  EXPECT_NEAR(term.statistics().largest_friction_lag, 0.3 * area * 2e3 * deeper, 1e-12);
}

TEST(ContactTangent, SecantTangentsEndWithTheirGuardAndAreNotMeasured) {
  World world(2, false, 3);
  world.state.u().head<3>() = Vec3(0.5, 0, 0);
  contact::ContactForce term;
  const int frame = term.add_frame(contact::fixed_frame());
  ContactSpec spec;
  spec.friction = 0.3;
  spec.friction_tangent = FrictionTangent::kFull;
  term.add_pair(std::make_unique<ListSource>(std::vector<contact::ContactSample>{
                    on_frame(node_point({0}, {1.0}), frame, Pose{}, {0, 0, 1}, 0.02, 0.7, world.state)}),
                spec);
  term.refresh(world.state.view());
  EXPECT_FALSE(term.traits().symmetric_tangent);
  {
    const contact::SecantTangents guard(term);
    EXPECT_TRUE(term.traits().symmetric_tangent);
    const MatX A = step_matrix(term, world.state, 1.0, 1.0).to_dense();
    EXPECT_EQ(A, A.transpose());
    EXPECT_EQ(term.statistics().largest_lagged_friction, 0.0);
    EXPECT_THROW(term.use_secant_tangents(true), InternalError);
  }
  EXPECT_FALSE(term.traits().symmetric_tangent);
  EXPECT_THROW(term.use_secant_tangents(false), InternalError);
}

// Secant through zero: with force and matrix of one state, F0 - D (v - v0), friction at any other velocity v
// is the friction at v0 times v / |v0|, along both tangents, so that it never does positive work; below v_r
// it is the tangent.
TEST(ContactTangent, TheSecantOfFrictionOpposesEveryVelocity) {
  constexpr double depth = 0.02, area = 0.7, k = 2e3, mu = 0.3, regularisation = 0.1;
  for (const Vec3& v0 : {Vec3(0.3, -0.4, 0.2), Vec3(0.03, 0.04, 0.0), Vec3(0.0, 0.0, 0.1)}) {
    World world(2, false, 3);
    world.state.u().setZero();
    world.state.u().head<3>() = v0;
    contact::ContactForce term;
    const int frame = term.add_frame(contact::fixed_frame());
    ContactSpec spec;
    spec.stiffness_pa_m = k;
    spec.friction = mu;
    spec.friction_regularisation_m_s = regularisation;
    spec.friction_tangent = FrictionTangent::kSecant;
    term.add_pair(std::make_unique<ListSource>(std::vector<contact::ContactSample>{
                      on_frame(node_point({0}, {1.0}), frame, Pose{}, {0, 0, 1}, depth, area, world.state)}),
                  spec);
    term.refresh(world.state.view());
    EXPECT_TRUE(term.traits().symmetric_tangent);
    const MatX D = step_matrix(term, world.state, 0.0, 1.0).to_dense().topLeftCorner(3, 3);
    EXPECT_LT((D - D.transpose()).norm(), 1e-14 * D.norm());
    VecX f = VecX::Zero(world.state.u().size());
    term.add_force(world.state.view(), f);
    const double pressing = area * k * depth, scale = std::max(v0.head<2>().norm(), regularisation);
    for (const Vec3& v : {Vec3(-0.2, 0.1, 0.0), Vec3(1.0, 2.0, 0.3), Vec3::Zero().eval()}) {
      const Vec3 force = f.head<3>() - D * (v - v0);
      EXPECT_LT(
          (force - Vec3(-mu * pressing / scale * v.x(), -mu * pressing / scale * v.y(), pressing)).norm(),
          1e-12 * pressing);
    }
  }
}

TEST(ContactTangent, TraitsSayWhatItIs) {
  EXPECT_FALSE(Scene(kLaws[0]).term.traits().symmetric_tangent);  // a body of the State acts as a frame
  contact::ContactForce term;
  term.add_frame(contact::fixed_frame());
  ContactSpec spec;
  term.add_pair(std::make_unique<ListSource>(std::vector<contact::ContactSample>{}), spec);
  EXPECT_TRUE(term.traits().symmetric_tangent);
  EXPECT_TRUE(term.traits().conservative);
  spec.friction = 0.2;
  term.add_pair(std::make_unique<ListSource>(std::vector<contact::ContactSample>{}), spec);
  EXPECT_FALSE(term.traits().symmetric_tangent);
  EXPECT_FALSE(term.traits().conservative);
}

// The linearisation for a prescribed frame: by its pose, by its twist, and by the nodes' positions and
// velocities.
TEST(FrameLinearisation, TaylorByPoseTwistAndNodes) {
  for (const Law& law : kLaws) {
    Scene scene(law);
    const auto view = scene.world.state.view();
    contact::FrameLinearisation lin;
    scene.term.linearise(view, 0, lin);
    EXPECT_EQ(lin.active, 3);
    const Wrench direct = scene.term.frame_wrench(view, 0);
    EXPECT_LT((direct.force - lin.wrench.force).norm() + (direct.moment - lin.wrench.moment).norm(), 1e-14);
    const int nodal = scene.world.state.layout().nodal_size;
    const auto wrench_and_nodes = [&](const dynamics::State& state) {
      VecX out(6 + nodal);
      const Wrench w = scene.term.frame_wrench(state.view(), 0);
      out << w.moment, w.force, force(scene.term, state).head(nodal);
      return out;
    };
    const VecX d = direction(6, 6);
    VecX by_pose(6 + nodal), by_twist(6 + nodal);
    by_pose << -(lin.K * d), -(lin.K_body * d);
    by_twist << -(lin.B * d), -(lin.B_body * d);
    const auto place = [&](const Pose& pose, const Twist& twist) {
      scene.given->clear();
      scene.given->append(0.0, pose, twist);
    };
    expect_derivative(
        [&](double h) {
          place({quaternion_of(h * d.head<3>()) * scene.given_pose.rotation,
                 scene.given_pose.translation + h * d.tail<3>()},
                scene.given_twist);
          return wrench_and_nodes(scene.world.state);
        },
        by_pose, 0.02, law.name);
    expect_derivative(
        [&](double h) {
          place(scene.given_pose,
                {scene.given_twist.angular + h * d.head<3>(), scene.given_twist.linear + h * d.tail<3>()});
          return wrench_and_nodes(scene.world.state);
        },
        by_twist, 0.05, law.name);
    place(scene.given_pose, scene.given_twist);
    VecX nodes = VecX::Zero(scene.world.state.layout().u_size);
    nodes.head(nodal) = direction(nodal, 7);
    const auto wrench = [&](const dynamics::State& state) { return VecX(wrench_and_nodes(state).head(6)); };
    expect_derivative([&](double h) { return wrench(scene.world.moved(nodes, h)); },
                      -(lin.K_frame * nodes.head(nodal)), 0.02, law.name);
    expect_derivative([&](double h) { return wrench(scene.world.pushed(nodes, h)); },
                      -(lin.B_frame * nodes.head(nodal)), 0.05, law.name);
  }
}

// Force is minus the gradient of the energy, in the nodes and in the body's pose (undamped, with other frames
// at rest).
TEST(ContactEnergy, ForceIsItsGradient) {
  Scene scene(kLaws[0]);
  scene.world.state.u().setZero();
  scene.given->clear();
  scene.given->append(0.0, scene.given_pose, {});
  const VecX d = direction(scene.world.state.layout().u_size, 8);
  VecX slope(1);
  slope << -force(scene.term, scene.world.state).dot(d);
  expect_derivative(
      [&](double h) {
        const dynamics::State moved = scene.world.moved(d, h);
        VecX e(1);
        e << scene.term.energy(moved.view());
        return e;
      },
      slope, 0.02, "energy");
}

// Power balance at any state: d(energy)/dt = -(power delivered to nodes and bodies) - dissipated power, with
// all frames at rest or in the State.
TEST(ContactEnergy, DissipationClosesThePowerBalance) {
  for (const Law& law : kLaws) {
    Scene scene(law, false);
    const VecX u = scene.world.state.u();
    const double given_power = force(scene.term, scene.world.state).dot(u),
                 dissipated = scene.term.dissipated_power(scene.world.state.view());
    const double h = 1e-6;
    const double rate = (scene.term.energy(scene.world.moved(u, h).view()) -
                         scene.term.energy(scene.world.moved(u, -h).view())) /
                        (2 * h);
    EXPECT_NEAR(rate, -given_power - dissipated, 1e-7 * (std::abs(given_power) + dissipated)) << law.name;
    EXPECT_GT(dissipated, 0.0);
  }
}

// A step's assembly outside of the pattern yields the matrix: the nodes' part as sums, rows and columns of
// frames as a border; its force is the term's less the tangent times the shift.
TEST(ContactTangent, TheStepHasTheBorderOfTheMatrix) {
  for (const Law& law : kLaws) {
    Scene scene(law, true, FrictionTangent::kSymmetric);
    ASSERT_TRUE(scene.term.is_point_stiffness());
    const dynamics::StateView at = scene.world.state.view();
    const int size = at.layout->u_size, nodal = at.layout->nodal_size;
    const VecX shift = direction(size, 7);
    VecX f = VecX::Zero(size);
    dynamics::PointStiffness C;
    dynamics::SparseBorder border;
    border.reset(at.layout->node_count(), size - nodal);
    scene.term.add_step(at, shift, 0.7, 0.3, f, C, border);
    MatX whole = MatX::Zero(size, size);
    for (int k = 0; k < size; ++k) {
      const VecX unit = VecX::Unit(size, k);
      VecX column = VecX::Zero(size), of_border = border.corner * unit.tail(size - nodal);
      C.add_product(unit, 1.0, column);
      border.add_right_product(unit, 1.0, column);
      border.add_bottom_product(unit, 1.0, of_border);
      column.tail(size - nodal) += of_border;
      whole.col(k) = column;
    }
    const MatX expected = step_matrix(scene.term, scene.world.state, 0.7, 0.3).to_dense();
    EXPECT_GT(expected.topRightCorner(nodal, size - nodal).norm(), 0.1);
    EXPECT_LE((whole - expected).norm(), 1e-13 * expected.norm()) << law.name;
    const VecX step = force(scene.term, scene.world.state) -
                      step_matrix(scene.term, scene.world.state, 1.0, 0.0).to_dense() * shift;
    EXPECT_LE((f - step).norm(), 1e-13 * step.norm()) << law.name;
  }
}
