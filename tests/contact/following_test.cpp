#include "surfaces.h"

using namespace contact_tests;

/// Between two queries, samples at material points follow the state.
namespace {

constexpr double kFar = 10.0;  // candidate gap that includes all vertices

/// A soft sphere over a rigid one of radius 2, whose top is at the origin of the frame.
struct Touch {
  TriMesh rest = sphere(Vec3(0.1, -0.05, 0.9), 1.0, 16);
  SurfaceWorld world{rest};
  std::shared_ptr<contact::MovingFrame> frame;
  contact::ContactForce term;

  explicit Touch(std::shared_ptr<contact::MovingFrame> motion = nullptr)
      : frame(motion ? motion : contact::fixed_frame()) {
    term.add_frame(frame);
    ContactSpec law;
    law.stiffness_pa_m = 1e3;
    term.add_pair(
        contact::make_sphere_source(contact::material_points(world.surface, rest.vertices, {}, kFar), 0,
                                    frame, Vec3(0, 0, -2), 2.0, kFar),
        law);
  }
  VecX force() {
    VecX f = VecX::Zero(world.state.layout().u_size);
    term.add_force(world.state.view(), f);
    return f;
  }
  /// Moves the sphere sideways and down and shears it, so that gaps, normals and areas all change.
  void deform() {
    const int first = world.state.layout().find("surface")->q_offset;
    for (Eigen::Index i = first; i < world.state.q().size(); i += 3) {
      const double z = world.state.q()[i + 2];
      world.state.q()[i] += 0.15 + 0.1 * z;
      world.state.q()[i + 1] *= 1.1;
      world.state.q()[i + 2] -= 0.02;
    }
  }
};

std::shared_ptr<contact::TrajectoryFrame> along(const Vec3& velocity) {
  auto frame = std::make_shared<contact::TrajectoryFrame>();
  frame->append(0.0, Pose{}, {Vec3::Zero(), velocity});
  return frame;
}

}  // namespace

TEST(Following, AForceBetweenQueriesIsThatOfAQueryThere) {
  Touch exact, fresh;
  exact.term.refresh(exact.world.state.view());
  const VecX before = exact.force();
  for (Touch* one : {&exact, &fresh}) one->deform();
  fresh.term.refresh(fresh.world.state.view());
  const VecX requested = fresh.force();
  ASSERT_GT(requested.norm(), 0.0);
  EXPECT_LT((exact.force() - requested).norm(), 1e-13 * requested.norm());
  EXPECT_GT((before - requested).norm(), 0.1 * requested.norm()) << "else there is nothing to follow";
  EXPECT_EQ(exact.term.statistics().queries, 1);
}

TEST(Following, EnergyWrenchEventsAndProductsAreOfTheSameState) {
  Touch exact, fresh;
  for (Touch* one : {&exact, &fresh}) one->term.refresh(one->world.state.view());
  for (Touch* one : {&exact, &fresh}) one->deform();
  fresh.term.refresh(fresh.world.state.view());
  const dynamics::StateView at = exact.world.state.view(), there = fresh.world.state.view();
  EXPECT_NEAR(exact.term.energy(at), fresh.term.energy(there), 1e-12 * fresh.term.energy(there));
  ASSERT_EQ(exact.term.event_count(), fresh.term.event_count()) << "all are candidates at both queries";
  VecX g(exact.term.event_count()), requested(g.size());
  exact.deform();
  fresh.deform();
  exact.term.events(at, g.data());  // first evaluation at this state
  fresh.term.refresh(there);
  fresh.term.events(there, requested.data());
  EXPECT_LT((g - requested).cwiseAbs().maxCoeff(), 1e-13);
  exact.deform();
  fresh.deform();
  fresh.term.refresh(there);
  EXPECT_LT((exact.term.frame_wrench(at, 0).force - fresh.term.frame_wrench(there, 0).force).norm(),
            1e-12 * fresh.term.frame_wrench(there, 0).force.norm());
  exact.deform();
  fresh.deform();
  fresh.term.refresh(there);
  VecX x = VecX::Ones(at.layout->u_size), y = VecX::Zero(x.size()), z = y;
  exact.term.apply_tangent(at, 1.0, 0.0, x, y);
  fresh.term.apply_tangent(there, 1.0, 0.0, x, z);
  ASSERT_GT(z.norm(), 0.0);
  EXPECT_LT((y - z).norm(), 1e-12 * z.norm());
}

TEST(Following, TheShapeMovesWithItsFrame) {
  Touch exact(along(Vec3(0.3, 0, 0.1))), fresh(along(Vec3(0.3, 0, 0.1)));
  exact.term.refresh(exact.world.state.view());
  for (Touch* one : {&exact, &fresh}) one->world.state.set_time(0.5);
  fresh.term.refresh(fresh.world.state.view());
  const VecX requested = fresh.force();
  EXPECT_LT((exact.force() - requested).norm(), 1e-13 * requested.norm());
}

/// A tool's path is extended between ticks, which changes the pose at the same time: samples must follow the
/// new pose.
TEST(Following, APathThatIsKnownBetterIsSeenAtTheSameTime) {
  const auto path = along(Vec3(0, 0, 0.1)), whole = along(Vec3(0, 0, 0.1));
  Touch exact(path), fresh(whole);
  exact.term.refresh(exact.world.state.view());
  for (Touch* one : {&exact, &fresh}) one->world.state.set_time(0.5);
  exact.force();
  for (const auto& one : {path, whole}) one->append(1.0, Pose{Quat::Identity(), Vec3(0.2, 0, 0.05)}, {});
  fresh.term.refresh(fresh.world.state.view());
  const VecX requested = fresh.force();
  EXPECT_LT((exact.force() - requested).norm(), 1e-13 * requested.norm());
}

TEST(Following, ARefreshChangesNoForceSoThatNoMethodRestarts) {
  Touch exact;
  exact.term.refresh(exact.world.state.view());
  exact.deform();
  EXPECT_FALSE(exact.term.refresh(exact.world.state.view()));
  EXPECT_EQ(exact.term.statistics().refresh_jump.force, 0.0);
}

TEST(Following, AFailedTrialOfAnIntegratorIsNoError) {
  Touch exact;
  exact.term.refresh(exact.world.state.view());
  exact.world.state.q()[exact.world.state.q().size() - 1] = std::nan("");
  EXPECT_NO_THROW(exact.force());
}

/// Samples that do not follow the state, such as vertices in an image, have gaps that are linear in the
/// positions.
TEST(Following, WhatDoesNotFollowHasLinearGaps) {
  Touch touch;
  touch.term.refresh(touch.world.state.view());
  contact::ContactForce term;
  term.add_frame(touch.frame);
  ContactSpec law;
  law.stiffness_pa_m = 1e3;
  term.add_pair(std::make_unique<ListSource>(touch.term.samples()), law);
  term.refresh(touch.world.state.view());
  const auto gaps = [&] {
    VecX g(term.event_count());
    term.events(touch.world.state.view(), g.data());
    return g;
  };
  const VecX first = gaps(), q = touch.world.state.q();
  touch.deform();
  const VecX second = gaps(), change = touch.world.state.q() - q;
  touch.world.state.q() = q + 0.5 * change;
  ASSERT_GT((second - first).norm(), 0.0);
  EXPECT_LT((gaps() - 0.5 * (first + second)).cwiseAbs().maxCoeff(), 1e-12);
}

/// Samples that do not follow have no material points, hence no anchors: a friction retardation adds no
/// stiffness.
TEST(Following, WithoutItARetardationChangesNoMatrix) {
  Touch touch;
  touch.term.refresh(touch.world.state.view());
  touch.world.state.u().setConstant(0.01);
  const auto matrix = [&](double retardation) {
    contact::ContactForce term;
    term.add_frame(touch.frame);
    ContactSpec law;
    law.stiffness_pa_m = 1e3;
    law.friction = 0.4;
    law.friction_tangent = FrictionTangent::kFull;
    law.friction_retardation_s = retardation;
    term.add_pair(std::make_unique<ListSource>(touch.term.samples()), law);
    term.refresh(touch.world.state.view());
    return step_matrix(term, touch.world.state, 1.0, 0.0).to_dense();
  };
  const auto without = matrix(0.0);
  EXPECT_GT(without.norm(), 0.0);
  EXPECT_EQ((matrix(0.01) - without).norm(), 0.0);
}
