// Two tools, each with a device, on one body.
#include <gtest/gtest.h>

#include <filesystem>

#include "hands_felt.h"
#include "loop/haptic_record.h"
#include "loop/replay.h"
#include "loop/summary.h"
#include "palpate/core/error.h"
#include "palpate/core/named_enum.h"
#include "palpate/loop/recorder.h"
#include "palpate/loop/run.h"
#include "small_scenes.h"
#include "store/force_file.h"
#include "summary_rows.h"

#ifdef PALPATE_HAS_TOOL

using namespace palpate;

namespace {

constexpr double kRadius = 0.015, kHalf = 0.02, kPress = 0.004;

/// A hand on one side, which starts 0.1 mm apart, penetrates by kPress within 0.1 s, and stays.
/// @param shift  offset of its contact along y [m]
void from(double side, double shift, ToolSpec& tool, DeviceSpec& device) {
  tool.radius_m = kRadius;
  tool.mass_kg = 0.05;
  tool.position_m = Vec3(side * (kHalf + kRadius + 1e-4), shift, 0.0);
  tool.coupling.stiffness_n_m = 300.0;
  tool.coupling.damping_n_s_m = 4.0;
  KeyframeSpec frame;
  frame.position_m = tool.position_m;
  device.keyframes = {frame};
  frame.time_s = 0.1;
  frame.position_m.x() -= side * kPress;
  device.keyframes.push_back(frame);
}

/// A free block between two hands.
scene::Description squeezed(double shift = 0.0) {
  scene::Description d = small_scenes::held_block();
  d.bodies[0].attachments.clear();
  d.bodies[0].position_m = Vec3::Zero();
  d.bodies[0].stiffness_damping_s = 5e-3;
  d.gravity_m_s2.setZero();
  d.duration_s = 0.3;
  from(1.0, shift, d.tool.emplace(), d.device.emplace());
  scene::HandSpec& other = d.hands.emplace_back();
  other.name = "left";
  from(-1.0, shift, other.tool, other.device);
  for (const char* tool : {"tool", "left"}) {
    ContactSpec contact;
    contact.first = "block";
    contact.second = tool;
    contact.stiffness_pa_m = 1e7;
    d.contacts.push_back(contact);
  }
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.005;
  return d;
}

double peak(const std::vector<loop::TickRecord>& ticks) {
  double out = 0.0;
  for (const loop::TickRecord& tick : ticks) out = std::max(out, tick.device.force.norm());
  return out;
}

/// RMS of the difference of the forces on a hand, relative to the peak of the second.
double difference(const std::vector<loop::TickRecord>& a, const std::vector<loop::TickRecord>& b) {
  EXPECT_EQ(a.size(), b.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    sum += (a[i].device.force - b[i].device.force).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size())) / peak(b);
}

// Action and reaction: nothing else holds the block, so that at rest both hands exert equal forces.
TEST(TwoHands, PressEquallyOnAFreeBlock) {
  for (const char* how : {"frozen", "condensed", "points", "monolithic", "single_rate"}) {
    scene::Description d = squeezed();
    if (const auto scheme = value_named<scene::ExchangeScheme>(how))
      d.exchange.scheme = *scheme;
    else
      d.exchange.linearisation = how;
    HandsFelt both;
    const loop::RunResult result = run(d, both);
    ASSERT_EQ(both.of[0].size(), 300u) << how;
    ASSERT_EQ(both.of[1].size(), 300u) << how;
    const double right = both.of[0].back().device.force.x(), left = both.of[1].back().device.force.x();
    EXPECT_GT(right, 0.2) << how;
    EXPECT_NEAR(left / right, -1.0, 2e-3) << how;
    ASSERT_EQ(result.more_hands.size(), 1u);
    EXPECT_EQ(result.more_hands[0].ticks, 300);
    EXPECT_EQ(result.ticks, 300);
  }
}

/// A ball between two hands that press and lift it.
scene::Description hanging(const std::string& how) {
  scene::Description d = squeezed();
  if (const auto scheme = value_named<scene::ExchangeScheme>(how))
    d.exchange.scheme = *scheme;
  else
    d.exchange.linearisation = how;
  d.integrator.step_s = d.exchange.contact_refresh_s;
  d.bodies[0].youngs_modulus_pa = 3e4;
  d.bodies[0].mesh = {};
  d.bodies[0].mesh.generator = "ball";
  d.bodies[0].mesh.radius_m = kHalf;
  d.bodies[0].mesh.element_size_m = 0.26 * kHalf;
  d.duration_s = 0.6;
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  for (const double side : {1.0, -1.0}) {  // pressed from the start, pressed more, and lifted
    ToolSpec& tool = side > 0.0 ? *d.tool : d.hands[0].tool;
    DeviceSpec& device = side > 0.0 ? *d.device : d.hands[0].device;
    tool.position_m.x() = side * (kHalf + kRadius - 2e-3);
    KeyframeSpec frame;
    frame.position_m = tool.position_m;
    device.keyframes = {frame};
    frame.time_s = 0.05;
    frame.position_m.x() -= side * 6e-3;
    device.keyframes.push_back(frame);
    frame.time_s = 0.4;
    frame.position_m.z() += 0.04;
    device.keyframes.push_back(frame);
  }
  for (ContactSpec& contact : d.contacts) {
    contact.damping_pa_s_m = 1e4;
    contact.friction = 0.8;
  }
  return d;
}

// Friction lifts a ball between two hands: once it is at rest each carries half of the weight; with every
// linearisation, and where a step of tool and block together is one linear solve.
TEST(TwoHands, HoldByFriction) {
  const double weight = 9.81 * loop::assemble(hanging("points"))->bodies[0].masses.sum();
  for (const char* how : {"condensed", "points", "monolithic", "single_rate"}) {
    HandsFelt both;
    run(hanging(how), both);
    double lifted[2] = {0.0, 0.0};
    for (const int hand : {0, 1})
      for (std::size_t i = 500; i < 600; ++i) lifted[hand] -= 0.01 * both.of[hand][i].device.force.z();
    EXPECT_NEAR((lifted[0] + lifted[1]) / weight, 1.0, 0.02) << how;
    EXPECT_NEAR(lifted[0] / weight, 0.5, 0.05) << how;
  }
}

// Exchanging the two hands does not change the result.
TEST(TwoHands, ChangePlaces) {
  const scene::Description d = squeezed(0.003);
  scene::Description other = d;
  std::swap(*other.tool, other.hands[0].tool);
  std::swap(*other.device, other.hands[0].device);
  HandsFelt a, b;
  run(d, a);
  run(other, b);
  EXPECT_LT(difference(a.of[0], b.of[1]), 1e-6);
  EXPECT_LT(difference(a.of[1], b.of[0]), 1e-6);
}

// Each hand's exchanges converge to the monolithic solution of the block and both tools, and depend on each
// other: the force on a tool at rest follows the other tool's motion within the period.
TEST(TwoHands, TendToOneSystem) {
  for (const char* linearisation : {"condensed", "points"}) {
    double error[2][2];
    // a linear model is of first order in the period and does not end contact; points have a tenth of its
    // error
    const double bar = std::string(linearisation) == "points" ? 0.005 : 0.08;
    scene::Description whole = squeezed(0.003);
    for (KeyframeSpec& frame : whole.hands[0].device.keyframes)  // at rest, touching
      frame.position_m.x() = -(kHalf + kRadius - 1e-3);
    whole.hands[0].tool.position_m = whole.hands[0].device.keyframes[0].position_m;
    // so many points that changes of their areas between exchanges are negligible
    for (ContactSpec& contact : whole.contacts) contact.quadrature_error = 2e-3;
    whole.integrator.name = "cvode-bdf";
    whole.integrator.rtol = 1e-6;
    whole.duration_s = 0.15;
    whole.tool->tick_s = whole.hands[0].tool.tick_s = 2e-4;  // so that the tick's error is negligible
    whole.exchange.linearisation_error = 0.0;
    scene::Description truth = whole;
    truth.exchange.scheme = scene::ExchangeScheme::kMonolithic;
    truth.exchange.exchange_period_s = truth.exchange.contact_refresh_s = 1e-3;
    HandsFelt exact;
    run(truth, exact);
    ASSERT_GT(peak(exact.of[1]), 0.2);
    for (const int fine : {0, 1}) {
      scene::Description d = whole;
      d.exchange.linearisation = linearisation;
      d.exchange.exchange_period_s = d.exchange.contact_refresh_s = fine ? 0.003 : 0.006;
      HandsFelt both;
      run(d, both);
      for (const int hand : {0, 1}) error[fine][hand] = difference(both.of[hand], exact.of[hand]);
    }
    for (const int hand : {0, 1}) {
      EXPECT_LT(error[1][hand], bar) << linearisation << ", hand " << hand;
      EXPECT_LT(error[1][hand], 0.8 * error[0][hand]) << linearisation << ", hand " << hand;
      RecordProperty(std::string(linearisation) + (hand ? "_left" : "_right"),
                     std::to_string(error[0][hand]) + " " + std::to_string(error[1][hand]));
    }
  }
}

// The work of both hands on the block and on their tools equals the stored plus the dissipated energy.
TEST(TwoHands, BalanceTheirEnergy) {
  for (const char* scheme : {"partitioned", "monolithic", "single_rate"}) {
    scene::Description d = squeezed();
    d.exchange.scheme = *value_named<scene::ExchangeScheme>(scheme);
    d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 1e-3;
    d.tool->tick_s = d.hands[0].tool.tick_s = 2e-4;
    d.integrator.name = "cvode-bdf";
    d.integrator.rtol = 1e-7;
    HandsFelt both;
    both.weighs = true;
    run(d, both);
    ASSERT_TRUE(both.last);
    double works[2] = {0.0, 0.0};
    for (const int hand : {0, 1}) {
      const auto& ticks = both.of[hand];
      for (std::size_t i = 1; i < ticks.size(); ++i)
        works[hand] -= 0.5 * (ticks[i].time - ticks[i - 1].time) *
                       (ticks[i].requested.force.dot(ticks[i].handle_twist.linear) +
                        ticks[i - 1].requested.force.dot(ticks[i - 1].handle_twist.linear));
    }
    EXPECT_GT(works[1], 1e-4);
    EXPECT_NEAR(both.last->hand / (works[0] + works[1]), 1.0, 1e-3) << scheme;
    EXPECT_LT(std::abs(both.last->unaccounted), 0.03 * both.last->hand) << scheme;
  }
}

TEST(TwoHands, OfOneSystemTickTogether) {
  scene::Description d = squeezed();
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  d.hands[0].tool.tick_s = 5e-4;
  try {
    loop::assemble(d);
    FAIL() << "its force would be filtered, and recorded, by another tick than it has";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("hand \"left\" has tick_s"), std::string::npos);
  }
}

TEST(TwoHands, TickByOneClock) {
  HandsFelt both;
  const loop::RunResult result = run(squeezed(), both, true);
  ASSERT_TRUE(result.real_time);
  ASSERT_GT(both.of[0].size(), 100u);
  EXPECT_EQ(both.of[0].size(), both.of[1].size());
  EXPECT_EQ(result.real_time->lateness_s.size(), both.of[0].size()) << "a tick of both is one";
  for (std::size_t i = 0; i < both.order.size(); ++i) EXPECT_EQ(both.order[i], i % 2);
  for (std::size_t i = 0; i < both.of[1].size(); ++i) {
    EXPECT_EQ(both.of[0][i].time, both.of[1][i].time);
    EXPECT_GE(both.of[1][i].record_version, 1u);
  }
  scene::Description d = squeezed();
  d.hands[0].tool.tick_s = 5e-4;
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.real_time = true;
  try {
    loop::run(*world, options);
    FAIL() << "two clocks";
  } catch (const Error& e) { EXPECT_NE(std::string(e.what()).find("one clock"), std::string::npos); }
}

// Each hand grasps with its switch: when one releases the block, the other keeps it.
TEST(TwoHands, GraspByThemselves) {
  scene::Description d = squeezed();
  d.duration_s = 0.6;
  d.tool->grasp_switch = d.hands[0].tool.grasp_switch = 0;
  d.device->presses = {{0, 0.15, 0.0}};
  d.hands[0].device.presses = {{0, 0.15, 0.2}};
  for (const bool is_left : {false, true}) {  // both move to the right, the left one more slowly
    DeviceSpec& device = is_left ? d.hands[0].device : *d.device;
    KeyframeSpec away = device.keyframes.back();
    away.time_s = 0.2;
    device.keyframes.push_back(away);
    away.time_s = 0.55;
    away.position_m.x() += is_left ? -0.02 : 0.02;
    device.keyframes.push_back(away);
  }
  d.device->max_force_n = d.hands[0].device.max_force_n = 20.0;
  const auto world = loop::assemble(d);
  HandsFelt both;
  loop::RunOptions options;
  options.observers = {&both};
  ASSERT_TRUE(loop::run(*world, options).status.ok());
  EXPECT_EQ(world->contact->statistics().grasps.closed, 2);
  const Vec3 block = world->positions(world->bodies[0]).rowwise().mean();
  EXPECT_NEAR(block.x(), 0.02 - kPress, 0.006) << "it went with the right hand";
  EXPECT_LT(both.of[1].back().device.force.norm(), 0.05) << "the left one is free";
}

TEST(TwoHands, AreRecordedEach) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "two_hands";
  std::filesystem::remove_all(folder);
  scene::Description d = squeezed();
  d.duration_s = 0.1;
  d.record.emplace();
  d.record->states = d.record->forces = true;
  d.record->state_period_s = 0.01;
  const auto world = loop::assemble(d);
  HandsFelt both;
  loop::RunFigures figures;
  loop::RunResult result;
  {
    loop::Recorder recorder(*world, folder.string());
    loop::RunOptions options;
    options.observers = {&recorder, &both, &figures};
    result = loop::run(*world, options);
  }
  for (const int hand : {0, 1}) {
    const auto rows = store::read_forces((folder / (hand ? "force-left.csv" : "force.csv")).string());
    ASSERT_EQ(rows.size(), both.of[hand].size());
    EXPECT_NEAR((rows.back().on_hand.force - both.of[hand].back().device.force).norm(), 0.0, 1e-9);
    EXPECT_NEAR(rows.back().tool.translation.x(), both.of[hand].back().tool.translation.x(), 1e-9);
  }
  store::Summary summary = loop::summarise(*world, result, 0.0, figures);
  ASSERT_EQ(summary.list("hands").size(), 2u);
  for (const std::size_t hand : {0u, 1u}) {
    const store::SummaryFields& row = summary.list("hands")[hand];
    EXPECT_EQ(std::get<std::string>(*summary_rows::find(row, "name")), hand ? "left" : "tool");
    EXPECT_EQ(summary_rows::count(row, "ticks"), static_cast<long long>(both.of[hand].size()));
    double peak_n = 0.0;
    for (const loop::TickRecord& tick : both.of[hand]) peak_n = std::max(peak_n, tick.device.force.norm());
    EXPECT_EQ(std::get<double>(*summary_rows::find(row, "peak_force_n")), peak_n);
  }
  // each hand's ticks are replayed bitwise from its record, and not from the other hand's
  const std::vector<loop::HapticRecord> records = loop::read_haptic_records(folder.string(), d);
  ASSERT_EQ(records.size(), 2u);
  for (const std::size_t hand : {0, 1}) {
    const auto& felt = both.of[hand];
    const auto retraced = loop::retrace(d, records, hand);
    ASSERT_EQ(retraced.size(), felt.size());
    EXPECT_EQ(records[hand].exchanges.size(), static_cast<std::size_t>(result.periods));
    std::size_t touching = 0;
    for (std::size_t i = 0; i < felt.size(); ++i) {
      EXPECT_EQ(retraced[i].device.force, felt[i].device.force) << hand << " at " << felt[i].time;
      EXPECT_EQ(retraced[i].device.moment, felt[i].device.moment);
      EXPECT_EQ(retraced[i].tool.translation, felt[i].tool.translation);
      touching += felt[i].contact.force.norm() > 0.1;
    }
    EXPECT_GT(touching, felt.size() / 4);
  }
  loop::HapticRecord mixed = records[0];
  mixed.models = records[1].models;
  EXPECT_NE(loop::retrace(d, {mixed, records[1]}).back().device.force, both.of[0].back().device.force);
}

}  // namespace
#endif
