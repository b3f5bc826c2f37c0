#include "loop/linearise.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "core/counters.h"
#include "loop/small_scenes.h"
#include "loop/tool_instance.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#ifdef PALPATE_HAS_TOOL
#include "palpate/tool/tool.h"

using namespace palpate;
using namespace palpate::small_scenes;

namespace {

loop::PartitionedTool& ticks_of(loop::World& world) { return *world.tools[0].partitioned(); }

dynamics::LinearisedContact record_of(loop::World& world, std::uint64_t version, double period_s,
                                      long& frozen_fallbacks) {
  return loop::linearise_contact(world, version, period_s, frozen_fallbacks).linear;
}

constexpr double kDepth = 0.002;

std::unique_ptr<loop::World> touching(const std::string& linearisation) {
  scene::Description d = pressed_block(kDepth);
  d.exchange.linearisation = linearisation;
  d.integrator.linear_solver = "cholmod";  // differences of 1e-7 are taken between steps
  auto world = loop::assemble(d);
  world->contact->refresh(world->state.view());
  return world;
}

Mat6 stiffness(const dynamics::LinearisedContact& record) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(record.J.data());
}

/// Wrench on the tool after one linearly implicit step of H, with the tool displaced by `dx` at its end.
Vec6 wrench_after_step(double H, const Vec3& dx) {
  const auto world = touching("frozen");
  Pose moved = ticks_of(*world).tool.pose();
  moved.translation += dx;
  ticks_of(*world).path->clear();  // at rest there from now on
  ticks_of(*world).path->append(0.0, moved, {});
  EXPECT_TRUE(world->stepper->advance_to(H).ok());
  const Wrench w = world->contact->frame_wrench(world->state.view(), world->tool_frame_index());
  Vec6 out;
  out << w.moment, w.force;
  return out;
}

// Definition of `condensed`: the change of the wrench after the bodies have responded to the tool's
// displacement by one linearly implicit step.
TEST(Linearise, CondensedIsTheAnswerOfOneImplicitStep) {
  const double H = 0.01, e = 1e-7;
  long fallbacks = 0;
  const auto world = touching("condensed");
  const dynamics::LinearisedContact record = record_of(*world, 1, H, fallbacks);
  EXPECT_EQ(record.source, dynamics::LinearisedContact::Source::kCondensed);
  EXPECT_EQ(fallbacks, 0);
  ASSERT_GT(record.samples, 0);
  const Mat6 J = stiffness(record);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec6 change =
        (wrench_after_step(H, e * Vec3::Unit(axis)) - wrench_after_step(H, -e * Vec3::Unit(axis))) / (2 * e);
    const Vec3 expected = J.block<3, 1>(3, 3 + axis);
    const double size = J.bottomRightCorner(3, 3).norm();
    EXPECT_LT((change.tail(3) - expected).norm(), 1e-8 * size) << "axis " << axis;
  }
}

TEST(Linearise, BodiesThatAnswerAreSofterThanFrozenOnes) {
  long fallbacks = 0;
  const Mat6 frozen = stiffness(record_of(*touching("frozen"), 1, 0.01, fallbacks));
  const Mat6 condensed = stiffness(record_of(*touching("condensed"), 1, 0.01, fallbacks));
  EXPECT_LT(frozen(5, 5), condensed(5, 5)) << "a Schur complement takes stiffness away";
  EXPECT_LT(condensed(5, 5), 0.0);
}

TEST(Linearise, AShortPeriodLeavesTheBodiesNoTimeToAnswer) {
  long fallbacks = 0;
  const Mat6 frozen = stiffness(record_of(*touching("frozen"), 1, 1e-9, fallbacks));
  const Mat6 condensed = stiffness(record_of(*touching("condensed"), 1, 1e-9, fallbacks));
  EXPECT_LT((frozen - condensed).norm(), 1e-6 * frozen.norm());
}

TEST(Linearise, FrozenRecordRepeatsTheContactAtItsOwnPose) {
  long fallbacks = 0;
  const auto world = touching("frozen");
  const dynamics::LinearisedContact record = record_of(*world, 7, 0.01, fallbacks);
  EXPECT_EQ(record.version, 7u);
  const Vec6 w = dynamics::contact_wrench(record, record.time, ticks_of(*world).tool.pose(),
                                          ticks_of(*world).tool.twist());
  const Wrench exact = world->contact->frame_wrench(world->state.view(), world->tool_frame_index());
  EXPECT_LT((w.tail<3>() - exact.force).norm(), 1e-14 * exact.force.norm());
  EXPECT_GT(exact.force.z(), 0.0) << "the block pushes the tool up";
}

/// The pressed block on a moving floor, with damping in the contact.
scene::Description block_on_moving_floor() {
  scene::Description d = pressed_block(0.002);
  d.exchange.linearisation = "condensed";
  d.contacts[0].damping_pa_s_m = 2e4;
  KeyframeSpec start, end;
  end.time_s = 3.0;
  end.position_m = Vec3(2e-4, -1e-4, 3e-4);
  end.interpolation = Interpolation::kLinear;
  d.bodies[0].attachments[0].keyframes = {start, end};
  d.integrator.linear_solver = "cholmod";  // differences of 1e-8 are taken between steps
  return d;
}

/// The block with a free bone that carries nine nodes of its middle layer, off the axis of the tool.
scene::Description block_around_free_bone() {
  scene::Description d = block_on_moving_floor();
  BoneSpec bone;
  bone.name = "bone";
  bone.shape = BoneShape::kBox;
  bone.size_m = Vec3(0.0202, 0.0202, 0.004);
  bone.position_m = Vec3(0.01, 0.0, 0.01);
  bone.mass_kg = 1e-3;
  bone.inertia_kg_m2 = Vec3(1e-7, 1e-7, 1e-7);
  d.bones.push_back(bone);
  AttachmentSpec tie;
  tie.region = Selection::kShape;
  tie.to = bone.name;
  d.bodies[0].attachments.push_back(tie);
  return d;
}

/// A pressed block in equilibrium with the tool, and then struck: every term of the derivation contributes,
/// and the changes over one period are so small that no sample opens or closes.
struct Struck {
  std::unique_ptr<loop::World> world;
  VecX q, u;
  double t0 = 0.0;
  Pose x0;

  explicit Struck(const scene::Description& d = block_on_moving_floor()) {
    world = loop::assemble(d);
    loop::RunOptions options;
    options.duration_s = 1.5;
    EXPECT_TRUE(loop::run(*world, options).status.ok());
    x0 = ticks_of(*world).tool.pose();
    t0 = world->state.time();
    hold(x0, {}, t0);
    world->contact->refresh(world->state.view());
    u = world->state.u();
    for (Eigen::Index i = 0; i < u.size(); ++i) u[i] += 1e-5 * std::sin(1.0 + 7.0 * static_cast<double>(i));
    q = world->state.q();
    world->system.impose(world->state.layout(), t0, q.data(), u.data());
    back();
  }
  void hold(const Pose& pose, const Twist& twist, double t) {
    ticks_of(*world).path->clear();
    ticks_of(*world).path->append(t, pose, twist);
  }
  void back() {
    hold(x0, {}, t0);
    ticks_of(*world).tool.set_state(t0, x0, {});
    world->state.set_time(t0);
    world->state.q() = q;
    world->state.u() = u;
    world->stepper->reinit(dynamics::ReinitReason::kStateChanged);
  }
  Vec6 wrench() const {
    const Wrench w = world->contact->frame_wrench(world->state.view(), world->tool_frame_index());
    Vec6 out;
    out << w.moment, w.force;
    return out;
  }
  /// Wrench after one linearly implicit step of H, at whose end the tool is displaced by dx and moves with
  /// dv.
  Vec6 after_step(double H, const Vec6& dx, const Vec6& dv) {
    back();
    const Pose moved{quaternion_of(dx.head<3>()) * x0.rotation, x0.translation + dx.tail<3>()};
    hold(moved, {dv.head<3>(), dv.tail<3>()}, t0 + H);
    world->stepper->advance_to(t0 + H);
    return wrench();
  }
};

void expect_wrench_after_one_step(Struck& s) {
  const double H = 0.01, tick = s.world->description.tool->tick_s;
  long fallbacks = 0;
  const dynamics::LinearisedContact record = record_of(*s.world, 1, H, fallbacks);
  ASSERT_EQ(record.source, dynamics::LinearisedContact::Source::kCondensed);
  const Vec6 now = s.wrench();
  for (const double h : {tick, H}) {
    const Vec6 expected = s.after_step(h, Vec6::Zero(), Vec6::Zero());
    const Vec6 got = dynamics::contact_wrench(record, s.t0 + h, s.x0, {});
    const double change = (expected - now).norm();
    ASSERT_GT(change, 1e-6 * now.norm()) << "the bodies move";
    EXPECT_LT((got - expected).norm(), 1e-6 * change) << "after " << h << " s";
  }
}

// The bodies' own motion, after a tick and after the period: velocities, unbalanced forces, driven nodes and
// damping.
TEST(Linearise, CondensedRecordIsTheWrenchAfterOneImplicitStepOfMovingBodies) {
  Struck s;
  expect_wrench_after_one_step(s);
}

// A bone that turns takes the forces of the nodes that it carries along.
TEST(Linearise, CondensedRecordKnowsTheForcesThatTurnWithABone) {
  Struck s(block_around_free_bone());
  ASSERT_EQ(s.world->bones[0].dofs.size(), 3u * 9u);
  s.u.tail<6>().head<3>() += Vec3(0.02, -0.01, 0.03);  // rad/s
  VecX q = s.q;
  s.world->system.impose(s.world->state.layout(), s.t0, q.data(), s.u.data());
  s.back();
  expect_wrench_after_one_step(s);
}

// The tool moves as well: one step of the coupled system is linear in the tool's final position.
TEST(Linearise, CondensedRecordFollowsTheToolsDisplacementAndTwist) {
  Struck s;
  const double H = 0.01, e = 1e-8;
  long fallbacks = 0;
  const dynamics::LinearisedContact record = record_of(*s.world, 1, H, fallbacks);
  int checked = 0;
  for (int k = 0; k < 12; ++k, ++checked) {
    const double scale = k % 6 < 3 ? 1.0 / 0.015 : 1.0;  // radians per metre at the tool's surface
    Vec6 dx = Vec6::Zero(), dv = Vec6::Zero();
    (k < 6 ? dx : dv)[k % 6] = (k < 6 ? 1.0 : 10.0) * scale * e;
    const Vec6 change = s.after_step(H, dx, dv) - s.after_step(H, -dx, -dv);
    const Pose ahead{quaternion_of(dx.head<3>()) * s.x0.rotation, s.x0.translation + dx.tail<3>()};
    const Pose behind{quaternion_of(-dx.head<3>()) * s.x0.rotation, s.x0.translation - dx.tail<3>()};
    const Vec6 linear = dynamics::contact_wrench(record, s.t0 + H, ahead, {dv.head<3>(), dv.tail<3>()}) -
                        dynamics::contact_wrench(record, s.t0 + H, behind, {-dv.head<3>(), -dv.tail<3>()});
    // the moving floor changes the contact by 5e-4 of its depth meanwhile: a product of both changes
    EXPECT_LT((change - linear).norm(), 2e-3 * change.norm() + 1e-16) << "direction " << k;
  }
  EXPECT_EQ(checked, 12);
}

TEST(Linearise, AnIndefiniteStepMatrixIsFactoredByLu) {
  scene::Description d = pressed_block(kDepth);
  d.exchange.linearisation = "condensed";
  auto world = loop::assemble(d);
  Eigen::Map<Points> x(world->state.q().data(), 3, world->state.q().size() / 3);
  x.row(2) *= 0.2;  // flattened: compressed struts
  x.row(2).array() += 0.8 * 0.02 - 1e-4;
  world->contact->refresh(world->state.view());
  dynamics::BorderedMatrix A;
  world->system.step_matrix(world->state.view(), 1.0, 1.0, 1.0, A);
  ASSERT_LT(A.to_dense().selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0) << "it is indefinite";
  counters::reset();
  long fallbacks = 0;
  const dynamics::LinearisedContact record = record_of(*world, 1, 1.0, fallbacks);
  EXPECT_EQ(record.source, dynamics::LinearisedContact::Source::kCondensed);
  EXPECT_EQ(fallbacks, 0);
  EXPECT_GE(counters::counter("loop.condensed_by_lu"), 1);
}

// Regression test: the tool was thrown away by 29 m. Where contact is so stiff that a period without response
// leaves 1e4 N, the record must include that the bodies yield.
TEST(Linearise, AStiffContactDoesNotThrowTheToolAway) {
  class Bounds : public loop::Observer {
   public:
    // Without the contact's energy, whose depth results from the interval between two samples.
    void period(loop::World& world, double) override {
      energy = std::max(energy, world.mechanical_energy() - world.contact->energy(world.state.view()));
    }
    void tick(const loop::TickRecord& tick) override {
      away = std::max(away, (tick.tool.translation - tick.handle.translation).norm());
      rotation = std::max(rotation, rotation_vector(tick.tool.rotation).norm());
    }
    double energy = 0.0, away = 0.0, rotation = 0.0;
  };
  for (const double stiffness : {1e8, 1e9, 1e10, 1e11, 1e12}) {
    scene::Description d = pressed_block(-0.001);  // 1 mm above
    KeyframeSpec down = d.device->keyframes.front(), up = down;
    down.time_s = 0.1;
    down.position_m.z() -= 0.005;
    up.time_s = 0.25;
    d.device->keyframes.push_back(down);
    d.device->keyframes.push_back(up);
    d.contacts[0].stiffness_pa_m = stiffness;
    d.duration_s = 0.3;
    const auto world = loop::assemble(d);
    Bounds bounds;
    loop::RunOptions options;
    options.observers = {&bounds};
    const loop::RunResult result = loop::run(*world, options);
    EXPECT_TRUE(result.status.ok()) << result.status.message;
    EXPECT_LT(bounds.away, 0.01) << "at " << stiffness << " Pa/m";
    // upper bound on the hand's work
    EXPECT_LT(bounds.energy, 0.5 * d.tool->coupling.stiffness_n_m * 0.01 * 0.01)
        << "at " << stiffness << " Pa/m";
    EXPECT_LT(bounds.rotation, 1e-9) << "at " << stiffness
                                     << " Pa/m: without friction nothing rotates a sphere";
  }
}

}  // namespace
#endif
