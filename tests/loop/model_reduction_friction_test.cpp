// Friction of a tool on reduced bodies: what sticks, what slides, and which bases it takes.
#include <gtest/gtest.h>

#include <array>

#include "core/counters.h"
#include "loop/coupling/contact_loads.h"
#include "loop/small_scenes.h"
#include "palpate/loop/load.h"
#ifdef PALPATE_HAS_TOOL
#include "loop/reduced_ticks.h"

using namespace palpate;
using namespace palpate::reduced_ticks;
using namespace palpate::small_scenes;

namespace {

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
  d.contacts[0].friction_tangent = FrictionTangent::kSecant;
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
  for (const FrictionTangent tangent : {FrictionTangent::kFull, FrictionTangent::kSymmetric}) {
    d.contacts[0].friction_tangent = tangent;
    const auto other = touching(d, "points", 0.0, kCreep, kSpin);
    expect_same(whole_tick(*other), exact, 1e-3);
    EXPECT_EQ(other->system.symmetric(), tangent != FrictionTangent::kFull) << "the pair has its own again";
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
  d.contacts[0].friction_tangent = FrictionTangent::kSecant;
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
  for (ContactSpec& contact : d.contacts) contact.friction_tangent = FrictionTangent::kSecant;
  d.tool->position_m.z() -= 0.0025;  // 1 mm deep in the ball
  const auto [without, with] = bases_anew(d, 1);
  EXPECT_GT(without, 0);
  EXPECT_LE(with, without + 1);
}

}  // namespace
#endif
