#include "loop/coupling/model_reduction.h"

#include <gtest/gtest.h>

#include <array>

#include "core/counters.h"
#include "loop/coupling/contact_loads.h"
#include "loop/linearise.h"
#include "loop/small_scenes.h"
#include "loop/summary.h"
#include "loop/tool_instance.h"
#include "palpate/contact/contact_force.h"
#include "palpate/loop/load.h"
#include "palpate/loop/run.h"
#ifdef PALPATE_HAS_TOOL
#include "palpate/tool/tool.h"

using namespace palpate;
using namespace palpate::small_scenes;

namespace {

constexpr double kPeriod = 0.01;

/// The block under the tool, with its nodes moving at about `speed`.
/// @param spin  angular velocity of the tool about the vertical [rad/s]
std::unique_ptr<loop::World> touching(scene::Description d, const std::string& linearisation,
                                      double error = 0.0, double speed = 1e-3, double spin = 0.0) {
  d.exchange.linearisation = linearisation;
  d.exchange.linearisation_error = error;
  d.tool->tick_s = kPeriod;
  auto world = loop::assemble(d);
  contact::TrajectoryFrame& path = *world->tools[0].with_ticks()->path;
  const Pose pose = world->tool_pose();
  path.clear();
  path.append(0.0, pose, {Vec3(0, 0, spin), Vec3::Zero()});
  world->contact->refresh(world->state.view());
  VecX u = world->state.u();
  for (Eigen::Index i = 0; i < u.size(); ++i) u[i] += speed * std::sin(1.0 + 7.0 * static_cast<double>(i));
  VecX q = world->state.q();
  world->system.impose(world->state.layout(), 0.0, q.data(), u.data());
  world->state.u() = u;
  return world;
}

struct Linear {
  Vec6 F;
  Mat6 J, B;
  explicit Linear(const dynamics::LinearisedContact& r)
      : F(Eigen::Map<const Vec6>(r.F0.data())),
        J(Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(r.J.data())),
        B(Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(r.B.data())) {}
};

loop::ContactRecord record_of(loop::World& world) {
  long fallbacks = 0;
  const loop::ContactRecord record = loop::linearise_contact(world, 1, kPeriod, fallbacks);
  EXPECT_EQ(fallbacks, 0);
  return record;
}

/// Tolerance of the friction at a tick's end, as tight as Newton's method allows, so that comparisons do not
/// depend on it.
constexpr double kSettled = 1e-9;

/// The first tick, with friction at its end, while the tool continues its motion.
Linear tick_of(loop::World& world, double length) {
  const loop::ContactRecord record = record_of(world);
  EXPECT_EQ(record.linear.source, dynamics::LinearisedContact::Source::kPoints);
  contact::ReducedContactStepper ticks(world.description.contacts);
  ticks.adopt(record.touch);
  const Pose pose = world.tool_pose();
  const Twist twist = world.tool_twist();
  dynamics::LinearisedContact tick = ticks.linearise(length, length, {pose, twist});
  const dynamics::RigidMotion end{
      {quaternion_of(length * twist.angular) * pose.rotation, pose.translation + length * twist.linear},
      twist};
  while (!ticks.update_friction(end, kSettled)) tick = ticks.relinearise();
  return Linear(tick);
}

/// One tick with the length of the period.
Linear whole_tick(loop::World& world) { return tick_of(world, kPeriod); }

void expect_same(const Linear& a, const Linear& b, double error) {
  EXPECT_LE((a.F - b.F).tail<3>().norm(), error * b.F.tail<3>().norm());
  const auto of_force = [](const Mat6& m) { return Mat3(m.bottomRightCorner<3, 3>()); };
  EXPECT_LE((of_force(a.J) - of_force(b.J)).norm(), error * of_force(b.J).norm());
  EXPECT_LE((of_force(a.B) - of_force(b.B)).norm(),
            error * (of_force(b.B).norm() + kPeriod * of_force(b.J).norm()));
}

// Galerkin's solution is exact where the exact solution is in the span: one step over the period.
TEST(ModelReduction, OneTickOfAPeriodIsTheCondensedAnswer) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.005;  // several vertices press
  d.contacts[0].damping_pa_s_m = 2e4;
  const Linear condensed(record_of(*touching(d, "condensed")).linear);
  const auto world = touching(d, "points");
  const loop::ContactRecord record = record_of(*world);
  ASSERT_GT(record.touch.points, 3);
  ASSERT_GE(record.touch.modes, 4);
  expect_same(whole_tick(*world), condensed, 1e-7);
}

/// One tick of the period with all nodes, with friction at the tick's end while the tool continues its
/// motion: rows and columns of force only.
///     A du = H N^T (K Z dx + D Z dv),    dF = -Z^T (K Z dx + D Z dv) + Z^T (H K + D) N du
Linear tick_of_all_nodes(loop::World& world) {
  loop::StepFactor factor;
  const dynamics::StateView view = world.state.view();
  const bool has_friction = world.contact->begin_step(view);
  VecX s, w, column;
  loop::known_motion(world.system, world.state, kPeriod, s, w);
  std::vector<contact::ReducedTangent> tangents;
  std::vector<contact::ReducedSample> samples;
  MatX du;
  for (bool done = false; !done;) {
    dynamics::LinearSolver* solver = factor.of(world.system, view, kPeriod);
    samples = world.contact->reduced_samples(view, world.tool_frame_index(), &tangents);
    MatX loads = MatX::Zero(s.size(), 7);  // per x, per v, and without tool motion
    loads.col(6) = loop::right_hand_side(world.system, world.state, kPeriod, s, w, {});
    for (std::size_t j = 0; j < samples.size(); ++j)
      for (std::size_t k = 0; k < static_cast<std::size_t>(samples[j].count); ++k) {
        const double by = kPeriod * samples[j].weight[k];
        loads.block<3, 3>(3 * samples[j].node[k], 0) += by * tangents[j].K;
        loads.block<3, 3>(3 * samples[j].node[k], 3) += by * tangents[j].D;
      }
    for (Eigen::Index i = 0; i < 6; ++i) {
      column = loads.col(i);
      world.system.reduce(view, column);
      loads.col(i) = column;
    }
    du.resize(loads.rows(), 7);
    EXPECT_EQ(solver->solve(loads, du), dynamics::SolveStatus::kOk);
    for (Eigen::Index i = 0; i < 7; ++i) {
      column = du.col(i);
      world.system.expand(view, column);
      du.col(i) = column;
    }
    done = !has_friction ||
           world.contact->improve_step(view, s + kPeriod * du.col(6), w + du.col(6), {}, kSettled);
  }
  if (has_friction) world.contact->end_step();
  MatX force = MatX::Zero(3, 7);
  for (std::size_t j = 0; j < samples.size(); ++j) {
    const auto& [K, D] = tangents[j];
    const MatX moved = loop::moved_by(samples[j], [&](int node) { return MatX(du.middleRows<3>(3 * node)); });
    const Vec3 gone = loop::moved_by(samples[j], [&](int node) { return Vec3(s.segment<3>(3 * node)); });
    force += (kPeriod * K + D) * moved;
    force.leftCols<3>() -= K;
    force.middleCols<3>(3) -= D;
    force.col(6) += samples[j].force + K * gone;
  }
  dynamics::LinearisedContact out;
  Linear linear(out);
  linear.F << Vec3::Zero(), force.col(6);
  linear.J.setZero();
  linear.B.setZero();
  linear.J.bottomRightCorner<3, 3>() = force.leftCols<3>();
  linear.B.bottomRightCorner<3, 3>() = force.middleCols<3>(3);
  return linear;
}

// Where friction sticks, the surface follows a tool that moves along it: the body resists, rather than the
// regularised friction, which is several hundred times as stiff.
TEST(ModelReduction, WhatSticksGoesWithTheTool) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.005;
  d.contacts[0].friction = 0.8;
  d.contacts[0].friction_regularisation_m_s = 1e-3;
  constexpr double kCreep = 1e-7;
  const Linear condensed(record_of(*touching(d, "condensed", 0.0, kCreep)).linear),
      frozen(record_of(*touching(d, "frozen", 0.0, kCreep)).linear);
  ASSERT_LT(frozen.B(3, 3), 50.0 * condensed.B(3, 3)) << "nothing sticks here";
  const auto world = touching(d, "points", 0.0, kCreep);
  const Linear exact = tick_of_all_nodes(*world);
  expect_same(whole_tick(*world), exact, 1e-3);
  const Linear iterated = whole_tick(*touching(d, "points", 0.01, kCreep));
  for (const int axis : {3, 4}) EXPECT_NEAR(iterated.B(axis, axis) / exact.B(axis, axis), 1.0, 0.1);
}

// Under a spinning tool, samples stick at the centre and slide around it: each kind responds according to its
// friction.
TEST(ModelReduction, WhatSlidesIsNotTakenForWhatSticks) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.004;
  d.contacts[0].friction = 0.8;
  d.contacts[0].friction_tangent = "secant";
  constexpr double kCreep = 1e-7, kSpin = 0.35;
  const auto world = touching(d, "points", 0.0, kCreep, kSpin);
  int stick = 0, slide = 0;
  for (const contact::ReducedSample& s :
       world->contact->reduced_samples(world->state.view(), world->tool_frame_index())) {
    if (!(s.gap < 0.0)) continue;
    const double slip = kSpin * (s.place - world->tool_pose().translation).head<2>().norm();
    stick += slip < 1e-3;
    slide += slip > 1.8e-3;
  }
  ASSERT_GE(stick, 2);
  ASSERT_GE(slide, 3);
  const Linear exact = tick_of_all_nodes(*world);
  expect_same(whole_tick(*world), exact, 1e-3);
  // for any friction tangent of the bodies' steps, the ticks' friction is the same
  for (const char* tangent : {"full", "symmetric"}) {
    d.contacts[0].friction_tangent = tangent;
    const auto other = touching(d, "points", 0.0, kCreep, kSpin);
    expect_same(whole_tick(*other), exact, 1e-3);
    EXPECT_EQ(other->system.symmetric(), std::string(tangent) != "full") << "the pair has its own again";
  }
}

/// Number of times that an exchange rebuilds its basis on shaking bodies, with and without friction in one
/// contact.
/// @return {without, with}
std::array<long, 2> bases_anew(scene::Description d, std::size_t contact) {
  const double friction = d.contacts[contact].friction;
  std::array<long, 2> out{};
  for (const bool has_friction : {false, true}) {
    d.contacts[contact].friction = has_friction ? friction : 0.0;
    counters::reset();
    record_of(*touching(d, "points", 0.1, 0.02));
    out[has_friction] = counters::snapshot()["loop.touch_bases_anew"];
  }
  return out;
}

// The basis follows the tool's friction only: friction on the floor on which the block shakes requires no
// other basis.
TEST(ModelReduction, FrictionElsewhereTakesNoBasis) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.005;
  d.bodies[0].position_m.z() = 0.0097;  // 0.3 mm deep in the floor
  d.contacts[0].friction = 0.8;
  d.contacts[0].friction_tangent = "secant";
  d.bodies[0].attachments[0].box_min_m = Vec3(-1, -1, -1);
  d.bodies[0].attachments[0].box_max_m = Vec3(-0.0199, 1, 1);
  add_floor(d, d.contacts[0]);
  const auto [without, with] = bases_anew(d, 1);
  EXPECT_GT(without, 0);
  EXPECT_LE(with, without + 1);
}

// Friction between two bodies, found in an image, requires no other basis either.
TEST(ModelReduction, FrictionBetweenBodiesTakesNoBasis) {
  scene::Description d = loop::load(PALPATE_SOURCE_DIR "/scenes/press-stack.toml");
  for (ContactSpec& contact : d.contacts) contact.friction_tangent = "secant";
  d.tool->position_m.z() -= 0.0025;  // 1 mm deep in the ball
  const auto [without, with] = bases_anew(d, 1);
  EXPECT_GT(without, 0);
  EXPECT_LE(with, without + 1);
}

TEST(ModelReduction, AFewIterationsAnswerToTheErrorAskedFor) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.004;
  d.contacts[0].damping_pa_s_m = 2e4;
  const Linear factored = whole_tick(*touching(d, "points"));
  counters::reset();
  const auto world = touching(d, "points", 0.01);
  const Linear iterated = whole_tick(*world);
  EXPECT_GT(counters::snapshot()["loop.touch_iterations"], 0);
  EXPECT_EQ(counters::snapshot()["loop.touch_factored"], 0);
  expect_same(iterated, factored, 0.01);
}

// Includes every term that the iteration leaves to be computed: a moving support, a floor under the block,
// mass damping, and the inertia in a tick shorter than the period.
TEST(ModelReduction, IterationsKnowFloorSupportAndDamping) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.005;
  d.bodies[0].position_m.z() = 0.0097;  // 0.3 mm deep in the floor
  d.bodies[0].mass_damping_per_s = 200.0;
  d.contacts[0].damping_pa_s_m = 2e4;
  AttachmentSpec& side = d.bodies[0].attachments[0];
  side.box_min_m = Vec3(-1, -1, -1);
  side.box_max_m = Vec3(-0.0199, 1, 1);
  KeyframeSpec start, end;
  end.time_s = 1.0;
  end.position_m = Vec3(0.05, -0.02, 0.1);
  side.keyframes = {start, end};
  add_floor(d, d.contacts[0]);
  for (const double tick : {kPeriod, 0.1 * kPeriod}) {
    const Linear factored = tick_of(*touching(d, "points"), tick);
    counters::reset();
    const Linear iterated = tick_of(*touching(d, "points", 1e-4), tick);
    EXPECT_EQ(counters::snapshot()["loop.touch_factored"], 0);
    expect_same(iterated, factored, 0.01);
  }
}

// A coarse basis has a one-sided error: reduced bodies are never softer than the bodies.
TEST(ModelReduction, ACrudeBasisIsTooStiffNeverTooSoft) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.004;
  const Linear factored = whole_tick(*touching(d, "points")), crude = whole_tick(*touching(d, "points", 0.9));
  EXPECT_LT(crude.J(5, 5), factored.J(5, 5) * (1.0 + 1e-6));
}

// Error report of a run: the bound is at most the requested error, and zero if all solves were factored.
TEST(ModelReduction, ARunSaysHowExactlyBodiesAnswered) {
  scene::Description d = pressed_block(0.002);
  d.bodies[0].mesh.element_size_m = 0.004;
  double largest = 0.0;
  for (const double requested : {0.3, 0.01, 0.0}) {
    d.exchange.linearisation_error = requested;
    const auto world = loop::assemble(d);
    ASSERT_TRUE(loop::run(*world, {}).status.ok());
    const std::vector<loop::AnswerError> all = loop::answer_errors_of(*world);
    ASSERT_EQ(all.size(), 1u);
    const loop::AnswerError& e = all[0];
    EXPECT_EQ(e.tool, "tool");
    EXPECT_EQ(e.requested, requested);
    EXPECT_GE(e.exchanges, 4);
    EXPECT_EQ(e.factored, requested > 0.0 ? 0 : e.exchanges);
    EXPECT_EQ(e.beyond, 0);
    EXPECT_LE(e.largest, requested);
    EXPECT_LE(e.mean, e.largest);
    if (requested == 0.01) { EXPECT_LT(e.largest, 0.2 * largest); }
    EXPECT_EQ(e.largest > 0.0, requested > 0.0);
    largest = e.largest;
  }
  const auto apart = loop::assemble(pressed_block(-0.05));
  ASSERT_TRUE(loop::run(*apart, {}).status.ok());
  EXPECT_TRUE(loop::answer_errors_of(*apart).empty());
}

/// Contact forces, tick by tick, of a tool that a stiff coupling presses down on the block over two long
/// periods, with the second record `ticks` late.
std::vector<double> forces_with_latency(int ticks) {
  scene::Description d = pressed_block(0.001);
  d.tool->coupling.stiffness_n_m = 1e5;
  d.tool->coupling.damping_n_s_m = 100.0;
  KeyframeSpec down = d.device->keyframes[0];
  down.time_s = 0.08;
  down.position_m.z() -= 0.004;
  d.device->keyframes.push_back(down);
  d.exchange.exchange_period_s = 0.05;
  d.duration_s = 0.1;
  d.exchange.latency_ticks = ticks;
  struct Keep : loop::Observer {
    void tick(const loop::TickRecord& tick) override { forces.push_back(tick.contact.force.z()); }
    std::vector<double> forces;
  } keep;
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.observers = {&keep};
  EXPECT_TRUE(loop::run(*world, options).status.ok());
  return keep.forces;
}

// A record of a past time is advanced to the tick that adopts it, along the tool's path since then: the block
// is then where a prompt record would place it.
TEST(ModelReduction, ALateRecordKnowsWhatTheToolHasDoneSince) {
  constexpr int kLate = 25;
  constexpr std::size_t kSecond = 50, kTaken = kSecond + kLate;
  const std::vector<double> prompt = forces_with_latency(0), late = forces_with_latency(kLate);
  ASSERT_EQ(prompt.size(), late.size());
  EXPECT_GT(late[kTaken - 1], 2.0 * prompt[kTaken - 1]) << "the record before says something else";
  for (std::size_t i = kTaken; i < prompt.size(); ++i) EXPECT_NEAR(late[i], prompt[i], 0.015 * prompt[i]);
}

// A body whose nodes are all held has points, and no mode to respond with.
TEST(ModelReduction, AHeldBodyHasPointsAlone) {
  for (const double error : {0.0, 0.1}) {
    scene::Description d = pressed_block(0.002);
    d.bodies[0].attachments[0].box_max_m = Vec3(1, 1, 1);
    const auto world = touching(d, "points", error);
    const loop::ContactRecord record = record_of(*world);
    EXPECT_GT(record.touch.points, 0);
    EXPECT_EQ(record.touch.modes, 0);
    EXPECT_GT(whole_tick(*world).F[5], 0.0);
  }
}

/// Displacement of each point due to a force on any other, held for a period: 3 points x 3 points.
MatX softness(const contact::ReducedContactModel& model) {
  constexpr int kMost = contact::ReducedContactModel::kMostModes;
  MatX modes(3 * model.points, kMost);
  for (int j = 0; j < model.points; ++j)
    modes.middleRows<3>(3 * j) = Eigen::Map<const Eigen::Matrix<double, 3, kMost>>(
        model.point[static_cast<std::size_t>(j)].modes.data());
  const VecX answer =
      (1.0 / (kPeriod * kPeriod) + Eigen::Map<const VecX>(model.stiffness.data(), kMost).array()).inverse();
  return modes * answer.asDiagonal() * modes.transpose();
}

// Two integrators leave a body without motion at rest to rounding, each differently: the record must not
// depend on the integrator.
TEST(ModelReduction, RoundingGivesNoDirection) {
  for (const double error : {0.0, 0.1}) {
    std::vector<MatX> seen;
    for (const double seed : {1.0, 2.0}) {
      scene::Description d = pressed_block(-1e-4);
      d.bodies[0].mesh.element_size_m = 0.005;
      d.exchange.linearisation = "points";
      d.exchange.linearisation_error = error;
      const auto world = loop::assemble(d);
      world->contact->refresh(world->state.view());
      VecX q = world->state.q();
      for (Eigen::Index i = 0; i < q.size(); ++i)
        q[i] += 1e-17 * std::sin(seed + 7.0 * static_cast<double>(i));
      world->state.q() = q;
      const loop::ContactRecord record = record_of(*world);
      ASSERT_GT(record.touch.points, 0);
      ASSERT_GE(record.touch.modes, 3);
      seen.push_back(softness(record.touch));
    }
    ASSERT_EQ(seen[0].rows(), seen[1].rows());
    // a basis of a few iterations has the responses to single precision
    EXPECT_LE((seen[0] - seen[1]).norm(), (error > 0.0 ? 1e-6 : 1e-12) * seen[0].norm());
  }
}

TEST(ModelReduction, NothingNearIsNoPoint) {
  const auto world = touching(pressed_block(-0.1), "points");
  EXPECT_EQ(record_of(*world).touch.points, 0);
}

// The element contributions of an exchange are reused by the step over the period that it begins, if there is
// such a step; other steps request nothing, and nothing is kept.
TEST(ModelReduction, TheStepTakesTheElementsOfItsExchange) {
  for (const bool linearised : {true, false}) {
    scene::Description d = pressed_block(1e-3);
    d.integrator.name = linearised ? "linearly-implicit-euler" : "backward-euler";
    d.integrator.linear_solver = "pcg-two-level";
    const auto world = loop::assemble(d);
    const long before = counters::counter("dynamics.kept_step_taken");
    const loop::RunResult result = loop::run(*world, {});
    ASSERT_TRUE(result.status.ok()) << result.status.message;
    EXPECT_EQ(counters::counter("dynamics.kept_step_taken") - before, linearised ? result.periods : 0);
    EXPECT_EQ(world->system.kept_step().versions.empty(), !linearised);
  }
}

}  // namespace
#endif
