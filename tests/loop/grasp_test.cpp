// The tool holds what it pressed while a switch of the handle is closed: it carries a weight, pulls a body
// that is attached elsewhere, and releases it.
#include <gtest/gtest.h>

#include <filesystem>

#include "loop/haptic_record.h"
#include "loop/linearise.h"
#include "loop/replay.h"
#include "loop/small_scenes.h"
#include "loop/ticks_of.h"
#include "loop/tool_instance.h"
#include "palpate/contact/contact_force.h"
#include "palpate/core/named_enum.h"
#include "palpate/loop/run.h"
#include "palpate/tool/tool.h"

namespace {

using namespace palpate;

const loop::TickRecord& at(const std::vector<loop::TickRecord>& ticks, double t) {
  for (const loop::TickRecord& tick : ticks)
    if (tick.time >= t - 1e-9) return tick;
  return ticks.back();
}

void press_switch(scene::Description& d, double start, double duration) {
  d.tool->grasp_switch = 2;
  d.device->presses = {{2, start, duration}};
}

/// A block in the air, penetrated by the tool by a millimetre, which holds it from the start.
scene::Description hanging_block() {
  scene::Description d = small_scenes::pressed_block(0.001);
  d.duration_s = 1.5;
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  d.bodies[0].attachments.clear();
  d.bodies[0].youngs_modulus_pa = 1e5;
  d.bodies[0].mass_damping_per_s = 20.0;  // damped to rest
  d.bodies[0].mesh.element_size_m = 0.005;
  d.tool->coupling.rotational_stiffness_n_m_rad = 1.0;
  d.tool->coupling.rotational_damping_n_m_s_rad = 5e-3;
  d.device->max_force_n = 10.0;
  press_switch(d, 0.0, 1.2);
  return d;
}

double mass_of(const scene::Description& d) { return d.bodies[0].density_kg_m3 * 0.04 * 0.04 * 0.02; }

// A body hanging at rest exerts m g on the hand, and a moment of m g times the distance to its centre; when
// released, it falls.
TEST(Grasp, WhatHangsHasItsWeight) {
  for (const char* linearisation : {"points", "condensed", "frozen", "monolithic", "single_rate"}) {
    scene::Description d = hanging_block();
    if (const auto scheme = value_named<scene::ExchangeScheme>(linearisation))
      d.exchange.scheme = *scheme;
    else
      d.exchange.linearisation = linearisation;
    const auto world = loop::assemble(d);
    const auto ticks = ticks_of(*world);
    const double weight = 9.81 * mass_of(d);
    const loop::TickRecord& still = at(ticks, 1.19);
    EXPECT_NEAR(still.contact.force.z(), -weight, 1e-4 * weight) << linearisation;
    EXPECT_LE(still.contact.force.head<2>().norm(), 1e-3 * weight) << linearisation;
    EXPECT_NEAR(still.device.force.z(), -weight, 1e-3 * weight) << linearisation;
    EXPECT_EQ(world->contact->statistics().grasps.closed, 1);
    EXPECT_EQ(world->contact->statistics().grasps.empty, 0);
    EXPECT_EQ(world->contact->statistics().grasps.points, 0);
    // no later than two periods after the switch
    EXPECT_EQ(at(ticks, 1.225).contact.force.norm(), 0.0) << linearisation;
    const Points now = world->positions(world->bodies[0]);
    const double t = d.duration_s - 1.21;  // time of fall against the drag
    const double drag = d.bodies[0].mass_damping_per_s,
                 fallen = 9.81 * (t / drag - (1 - std::exp(-drag * t)) / (drag * drag));
    EXPECT_NEAR(now.row(2).mean(), still.tool.translation.z() - 0.024 - fallen, 0.01) << linearisation;
  }
}

/// The block of pressed_block, with its lower face held: the tool presses it, grasps at 0.1 s, pulls and
/// turns.
/// @param waits  delay before it grasps [s]
scene::Description pulled_block(double waits = 0.0) {
  scene::Description d = small_scenes::pressed_block(0.0);
  d.duration_s = 0.5 + waits;
  d.bodies[0].mesh.element_size_m = 0.005;
  d.contacts[0].damping_pa_s_m = 1e4;
  const KeyframeSpec start = d.device->keyframes.front();
  const auto key = [&](double t, double z, const Vec3& turn) {
    KeyframeSpec k = start;
    k.time_s = t;
    k.position_m.z() += z;
    k.rotation_vector_rad = turn;
    d.device->keyframes.push_back(k);
  };
  key(0.08, -0.004, Vec3::Zero());
  key(0.12 + waits, -0.004, Vec3::Zero());
  key(0.35 + waits, 0.006, Vec3(0.1, -0.2, 0.3));
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.005;
  d.integrator.step_s = 0.0025;
  press_switch(d, 0.1 + waits, 0.0);
  return d;
}

double pull(const std::vector<loop::TickRecord>& ticks) { return -ticks.back().contact.force.z(); }

TEST(Grasp, PullsWithTheSwitchAlone) {
  scene::Description d = pulled_block();
  const double held = pull(ticks_of(d));
  EXPECT_GT(held, 0.3);
  d.device->presses.clear();
  EXPECT_EQ(pull(ticks_of(d)), 0.0);
  d.device->presses = {{1, 0.1, 0.0}};  // another switch
  EXPECT_EQ(pull(ticks_of(d)), 0.0);
  // closed before the tool is in contact: it holds nothing
  d.device->presses = {{2, 0.0, 0.0}};
  const auto world = loop::assemble(d);
  EXPECT_EQ(pull(ticks_of(*world)), 0.0);
  EXPECT_EQ(world->contact->statistics().grasps.empty, 1);
  EXPECT_EQ(world->contact->statistics().grasps.closed, 0);
}

struct Errors {
  double force = 0.0, torque = 0.0;  ///< RMS relative to the peak
};

Errors between(const std::vector<loop::TickRecord>& a, const std::vector<loop::TickRecord>& b) {
  EXPECT_EQ(a.size(), b.size());
  Errors out;
  double force = 0.0, torque = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    out.force += (a[i].device.force - b[i].device.force).squaredNorm();
    out.torque += (a[i].device.moment - b[i].device.moment).squaredNorm();
    force = std::max(force, b[i].device.force.norm());
    torque = std::max(torque, b[i].device.moment.norm());
  }
  const auto n = static_cast<double>(b.size());
  return {std::sqrt(out.force / n) / force, std::sqrt(out.torque / n) / torque};
}

// The force agrees with the monolithic solution of tool and block; the error of the exchange is small.
TEST(Grasp, IsNearToOneSystem) {
  scene::Description one = pulled_block();
  one.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  const auto reference = ticks_of(one);
  EXPECT_GT(pull(reference), 0.3);
  for (const char* linearisation : {"points", "condensed"}) {
    scene::Description d = pulled_block();
    d.exchange.linearisation = linearisation;
    const Errors errors = between(ticks_of(d), reference);
    EXPECT_LE(errors.force, 0.02) << linearisation;
    EXPECT_LE(errors.torque, 0.02) << linearisation;
  }
}

TEST(Grasp, IsRetracedBitForBit) {
  const scene::Description d = pulled_block();
  const std::string path = (std::filesystem::path(::testing::TempDir()) / "grasp.h5").string();
  {
    loop::HapticRecorder recorder(path);
    const auto world = loop::assemble(d);
    loop::RunOptions options;
    options.observers = {&recorder};
    ASSERT_TRUE(loop::run(*world, options).status.ok());
  }
  const loop::HapticRecord record = loop::read_haptic_record(path);
  const auto retraced = loop::retrace(d, {record});
  ASSERT_EQ(retraced.size(), record.ticks.size());
  for (std::size_t i = 0; i < retraced.size(); ++i) {
    ASSERT_EQ(retraced[i].device.force, record.ticks[i].device.force) << i;
    ASSERT_EQ(retraced[i].contact.moment, record.ticks[i].contact.moment) << i;
    ASSERT_EQ(retraced[i].switches, record.ticks[i].switches) << i;
  }
  EXPECT_GT(pull(retraced), 0.3);
  EXPECT_EQ(record.ticks.front().switches, 0u);
  EXPECT_EQ(record.ticks.back().switches, 4u);
  // the recorded hand closes the same switch
  Ticks felt;
  const auto world = loop::assemble(d, loop::recorded_hand(record));
  loop::RunOptions options;
  options.observers = {&felt};
  ASSERT_TRUE(loop::run(*world, options).status.ok());
  EXPECT_EQ(pull(felt.all), pull(record.ticks));
}

// In real time the bodies receive the switch a period later, and hold all the same.
TEST(Grasp, InRealTime) {
  const scene::Description d = pulled_block(0.5);
  const auto world = loop::assemble(d);
  Ticks ticks;
  loop::RunOptions options;
  options.real_time = true;
  options.observers = {&ticks};
  ASSERT_TRUE(loop::run(*world, options).status.ok());
  if (world->contact->statistics().grasps.closed == 0)
    GTEST_SKIP() << "the bodies missed the time of pressing";
  EXPECT_NEAR(pull(ticks.all), pull(ticks_of(d)), 0.1);
}

// A record's first tick with the length of the period is the condensed response (model_reduction_test.cpp),
// for held samples as well as for pressing ones: pulled off, where only the grasp acts.
TEST(Grasp, ModesAnswerWhatIsHeld) {
  constexpr double kPeriod = 0.01;
  const auto record = [&](const std::string& linearisation, double pull) {
    scene::Description d = small_scenes::pressed_block(0.002);
    d.bodies[0].mesh.element_size_m = 0.005;
    d.contacts[0].damping_pa_s_m = 2e4;
    d.exchange.linearisation = linearisation;
    d.exchange.linearisation_error = 0.0;
    d.tool->tick_s = kPeriod;
    auto world = loop::assemble(d);
    world->contact->set_grasp(world->tool_frame_index(), true);
    world->contact->refresh(world->state.view());
    EXPECT_GT(world->contact->statistics().grasps.points, 3);
    Pose away = world->tool_pose();
    away.translation += Vec3(1e-4, 0.0, pull);
    loop::PartitionedTool& ticks_of_tool = *world->tools[0].partitioned();
    ticks_of_tool.path->clear();
    ticks_of_tool.path->append(0.0, away, {});
    ticks_of_tool.tool.set_state(0.0, away, {});
    world->contact->refresh(world->state.view());
    long fallbacks = 0;
    const loop::ContactRecord out = loop::linearise_contact(*world, 1, kPeriod, fallbacks);
    EXPECT_EQ(fallbacks, 0);
    if (linearisation == "condensed") return out.linear;
    contact::ReducedContactStepper ticks(d.contacts);
    ticks.adopt(out.touch);
    return ticks.linearise(kPeriod, kPeriod, {away, {}});
  };
  using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  for (const double pull : {0.0, 0.004}) {  // while pressing, and pulled off by 2 mm
    const auto exact = record("condensed", pull), points = record("points", pull);
    const Eigen::Map<const Vec6> F(exact.F0.data()), F_points(points.F0.data());
    const Mat6 J = Eigen::Map<const RowMajor6>(exact.J.data()),
               J_points = Eigen::Map<const RowMajor6>(points.J.data());
    EXPECT_EQ(F[5]<0.0, pull> 0.0);
    EXPECT_LE((F_points - F).tail(3).norm(), 1e-7 * F.tail(3).norm());
    const auto of_force = [](const Mat6& m) { return Mat3(m.bottomRightCorner(3, 3)); };
    EXPECT_LE((of_force(J_points) - of_force(J)).norm(), 1e-7 * of_force(J).norm());
  }
}

}  // namespace
