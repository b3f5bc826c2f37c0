// Tools that touch each other, through a whole scene.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "hands_felt.h"
#include "loop/haptic_record.h"
#include "loop/replay.h"
#include "palpate/core/error.h"
#include "palpate/core/named_enum.h"
#include "palpate/loop/recorder.h"
#include "palpate/loop/run.h"
#include "small_scenes.h"

#ifdef PALPATE_HAS_TOOL

using namespace palpate;

namespace {

constexpr double kA = 0.02, kB = 0.03, kMass = 0.1;

/// Gives a tool the shape `kind` with half edge, or radius, `half`.
void shape(ToolSpec& tool, const std::string& kind, double half) {
  tool.mass_kg = kMass;
  tool.radius_m = half;
  tool.inertia_kg_m2 = Vec3::Constant(kMass * 4.0 * half * half / 6.0);
  if (kind == "sphere") return;
  tool.shape = ToolShape::kMesh;
  tool.mesh.generator = "box";
  tool.mesh.size_m = Vec3::Constant(2.0 * half);
  tool.mesh.element_size_m = half;
}

/// Two hands press their tools on each other along z, by 4 mm from first touch within 0.1 s, and stay.
scene::Description pressed(const std::string& first, const std::string& second) {
  scene::Description d;
  d.name = first + " on " + second;
  d.duration_s = 0.5;
  const auto hold = [](double side, const std::string& kind, double half, ToolSpec& tool,
                       DeviceSpec& device) {
    shape(tool, kind, half);
    tool.position_m = Vec3(0, 0, side * half);
    tool.coupling = {300.0, 8.0, 1.0, 0.02};
    KeyframeSpec key;
    key.position_m = tool.position_m;
    device.keyframes.push_back(key);
    key.time_s = 0.1;
    key.position_m.z() -= side * 2e-3;
    device.keyframes.push_back(key);
  };
  hold(1.0, first, kA, d.tool.emplace(), d.device.emplace());
  scene::HandSpec& left = d.hands.emplace_back();
  left.name = "left";
  hold(-1.0, second, kB, left.tool, left.device);
  ContactSpec contact;
  contact.first = "left";
  contact.second = "tool";
  contact.stiffness_pa_m = 1e7;
  d.contacts.push_back(contact);
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 5e-3;
  d.integrator.name = "linearly-implicit-euler";
  d.integrator.step_s = 1e-3;
  return d;
}

/// Overlap of the two tools in contact [m].
double depth(const HandsFelt& both) {
  return kA + kB -
         (both.of[0].back().tool.translation - both.of[1].back().tool.translation).dot(Vec3::UnitZ());
}

}  // namespace

// At rest a tool exerts the force of its hand, and of the other tool, by the law. For two balls it is k pi
// delta^2 R r/(R + r), to O(delta/R); for a ball's points on a flat face k pi delta^2 R, for the face's
// points on a ball k pi delta^2 (R - delta/2) (validation/b_free_tool.h), and the mean where both count: the
// face's points alone where the ball is the thicker one; k A delta for a face on a larger one, whose points
// extend beyond the smaller face.
TEST(ToolsMeet, AtRestTheyCarryEachOther) {
  for (const char* first : {"sphere", "box"})
    for (const char* second : {"sphere", "box"})
      for (const char* scheme : {"partitioned", "monolithic", "single_rate"}) {
        scene::Description d = pressed(first, second);
        d.exchange.scheme = *value_named<scene::ExchangeScheme>(scheme);
        d.contacts[0].quadrature_error = 1e-3;
        HandsFelt both;
        run(d, both);
        const std::string what = std::string(first) + ", " + second + ", " + scheme;
        const loop::TickRecord &a = both.of[0].back(), &b = both.of[1].back();
        EXPECT_GT(a.contact.force.z(), 0.3) << what;
        EXPECT_NEAR(a.contact.force.z() / a.requested.force.z(), 1.0, 1e-3) << what;
        EXPECT_LT((a.contact.force + b.contact.force).norm(), 1e-9) << what;
        EXPECT_LT(a.contact.force.head<2>().norm(), 1e-6) << what;
        EXPECT_LT(a.tool_twist.linear.norm(), 1e-4) << what;
        const double k = d.contacts[0].stiffness_pa_m, delta = depth(both);
        const bool ball_a = std::string(first) == "sphere", ball_b = std::string(second) == "sphere";
        const auto ball = [&](double r) { return k * std::numbers::pi * delta * delta * r; };
        const double law = ball_a && ball_b ? ball(kA * kB / (kA + kB))
                           : ball_a         ? ball(kA - delta / 4.0)
                           : ball_b         ? ball(kB - delta / 2.0)
                                            : k * 4.0 * kA * kA * delta;
        const double off = ball_a || ball_b ? 0.02 : 0.08;
        EXPECT_NEAR(a.contact.force.z() / law, 1.0, off) << what << ": " << delta;
      }
}

// Forces are equal and opposite at every tick, to rounding, during an impact, for any contact stiffness and
// with friction: the final states of both are solved as one system.
TEST(ToolsMeet, ForcesAreOppositeAtEveryTick) {
  for (const char* first : {"sphere", "box"})
    for (const char* second : {"sphere", "box"})
      for (const double stiffness : {1e6, 1e9, 1e13})
        for (const double friction : {0.0, 0.4}) {
          scene::Description d = pressed(first, second);
          d.contacts[0].stiffness_pa_m = stiffness;
          d.contacts[0].friction = friction;
          d.device->keyframes[1].position_m += Vec3(0.01, 0.005, 0);
          d.device->keyframes[1].rotation_vector_rad = Vec3(0.1, -0.2, 0.3);
          d.device->keyframes[1].time_s = 0.04;
          d.duration_s = 0.2;
          HandsFelt both;
          run(d, both);
          const std::string what =
              fmt::format("{} on {}, {:g} Pa/m, mu = {}", first, second, stiffness, friction);
          double largest = 0.0, opposite = 0.0;
          for (std::size_t i = 0; i < both.of[0].size(); ++i) {
            const Vec3 &a = both.of[0][i].contact.force, &b = both.of[1][i].contact.force;
            largest = std::max(largest, a.norm());
            opposite = std::max(opposite, (a + b).norm());
          }
          EXPECT_GT(largest, 0.1) << what;
          EXPECT_LT(largest, 30.0) << what << ": less than stops a tool within one tick";
          EXPECT_LT(opposite, 1e-8 * largest) << what;
        }
}

// A free tool struck by the other gains the momentum given by the forces of its ticks, and both rotate about
// their line of centres as one: the total angular momentum about the origin is that from the hand.
TEST(ToolsMeet, AStruckToolTakesTheMomentum) {
  scene::Description d = pressed("sphere", "sphere");
  d.hands[0].tool.coupling = {0.0, 0.0, 0.0, 0.0};
  d.contacts[0].friction = 0.3;
  d.device->keyframes[1].position_m += Vec3(0.004, 0, -0.02);
  HandsFelt both;
  run(d, both);
  Vec3 sum = Vec3::Zero(), about_point = Vec3::Zero();
  for (std::size_t i = 0; i < both.of[0].size(); ++i) {
    const loop::TickRecord &a = both.of[0][i], &b = both.of[1][i];
    sum += b.length * b.contact.force;
    about_point += b.length * (a.contact.moment + b.contact.moment +
                               (a.tool.translation - b.tool.translation).cross(a.contact.force));
  }
  const Vec3 gained = kMass * both.of[1].back().tool_twist.linear;
  EXPECT_GT(-gained.z(), 0.01);
  EXPECT_LT((gained - sum).norm(), 1e-12);
  EXPECT_LT(about_point.norm(), 1e-3 * kA * gained.norm());
}

// The contact of two balls has a single normal, along the line between their centres at the tick's start.
// Where their patch shrinks, the sum of normal forces, linear in the tick, decreases slightly more than the
// sum of pressures, which are not negative on any ring.
TEST(ToolsMeet, NoTickIsOutsideTheConeOfFriction) {
  constexpr double kMu = 0.3;
  scene::Description d = pressed("sphere", "sphere");
  d.contacts[0].friction = kMu;
  const auto go = [&](double t, double x, double y) {
    KeyframeSpec key = d.device->keyframes[1];
    key.time_s = t;
    key.position_m += Vec3(x, y, 0);
    d.device->keyframes.push_back(key);
  };
  go(0.17, 0.01, 0.0);
  go(0.25, -0.01, 0.0);
  go(0.35, 0.0, 0.008);
  go(0.45, 0.0, 0.008);
  HandsFelt both;
  run(d, both);
  int sticks = 0, slides = 0;
  for (std::size_t i = 1; i < both.of[0].size(); ++i) {
    const Vec3 normal =
        (both.of[0][i - 1].tool.translation - both.of[1][i - 1].tool.translation).normalized();
    const Vec3& force = both.of[0][i].contact.force;
    const double limit = kMu * force.dot(normal), along = (force - force.dot(normal) * normal).norm();
    EXPECT_LE(along, 1.003 * limit + 1e-12) << both.of[0][i].time;
    sticks += along < 0.9 * limit;
    slides += along > 0.998 * limit && limit > 0.0;
  }
  EXPECT_GT(sticks, 50);
  EXPECT_GT(slides, 50);
}

// The ticks converge to the error-controlled monolithic solution of both: to first order in their length.
TEST(ToolsMeet, TicksConvergeToTheMonolithicSystem) {
  scene::Description d = pressed("box", "sphere");
  d.device->keyframes[1].time_s = 0.02;
  d.duration_s = 0.06;
  scene::Description one = d;
  one.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  one.integrator.name = "cvode-bdf";
  one.integrator.rtol = 1e-8;
  HandsFelt reference;
  run(one, reference);
  double before = 0.0;
  for (const std::size_t n : {1, 2, 4}) {
    d.tool->tick_s = d.hands[0].tool.tick_s = 1e-3 / static_cast<double>(n);
    HandsFelt both;
    run(d, both);
    double error = 0.0;
    for (std::size_t i = 0; i < reference.of[0].size(); ++i)
      for (const int hand : {0, 1})
        error = std::max(
            error, (both.of[hand][n * (i + 1) - 1].tool.translation - reference.of[hand][i].tool.translation)
                       .norm());
    if (n > 1) { EXPECT_NEAR(std::log2(before / error), 1.0, 0.25) << n << ": " << error; }
    before = error;
  }
  EXPECT_LT(before, 5e-5);
}

// A tool between another tool and the floor: the load on its top is transmitted to the floor.
TEST(ToolsMeet, AnObstacleCarriesAChainOfThem) {
  scene::Description d = pressed("sphere", "box");
  ObstacleSpec floor;
  floor.name = "floor";
  floor.type = "plane";
  floor.shape = {{"position_m", Vec3(0, 0, -2.0 * kB)}};
  d.obstacles.push_back(floor);
  ContactSpec below = d.contacts[0];
  below.first = "left";
  below.second = "floor";
  d.contacts.push_back(below);
  d.hands[0].tool.coupling = {0.0, 0.5, 0.0, 0.005};
  HandsFelt both;
  run(d, both);
  const loop::TickRecord &a = both.of[0].back(), &b = both.of[1].back();
  EXPECT_GT(a.contact.force.z(), 0.3);
  EXPECT_LT(b.contact.force.norm(), 1e-3 * a.contact.force.z()) << "as much from below as from above";
  EXPECT_NEAR(a.contact.force.z() / a.requested.force.z(), 1.0, 1e-3);
}

// The lower tool lies on a soft block: the records of the bodies act in addition to the other tool's contact,
// and the result converges to the monolithic solution of all three.
TEST(ToolsMeet, BesideASoftBody) {
  scene::Description d = pressed("sphere", "sphere");
  SoftBodySpec block = small_scenes::held_block().bodies[0];
  block.mesh.size_m = Vec3(0.06, 0.06, 0.02);
  block.position_m = Vec3(0, 0, -2.0 * kB - 0.01);
  block.attachments[0].box_min_m.z() = -1.0;
  block.attachments[0].box_max_m.z() = -2.0 * kB - 0.02 + 1e-6;
  d.bodies.push_back(block);
  ContactSpec below = d.contacts[0];
  below.first = "block";
  below.second = "left";
  d.contacts.push_back(below);
  d.hands[0].tool.coupling = {20.0, 0.5, 0.1, 0.005};
  d.duration_s = 1.0;
  std::vector<HandsFelt> both(2);
  for (const bool partitioned : {true, false}) {
    d.exchange.scheme =
        partitioned ? scene::ExchangeScheme::kPartitioned : scene::ExchangeScheme::kMonolithic;
    run(d, both[partitioned ? 0 : 1]);
  }
  for (const int hand : {0, 1}) {
    const loop::TickRecord &ticks = both[0].of[hand].back(), &one = both[1].of[hand].back();
    EXPECT_GT(both[0].of[0].back().contact.force.z(), 0.1);
    EXPECT_LT((ticks.tool.translation - one.tool.translation).norm(), 1e-6) << hand;
    EXPECT_LT((ticks.contact.force - one.contact.force).norm(), 1e-3) << hand;
    double farthest = 0.0;
    for (std::size_t i = 0; i < both[0].of[hand].size(); ++i)
      farthest = std::max(
          farthest, (both[0].of[hand][i].tool.translation - both[1].of[hand][i].tool.translation).norm());
    EXPECT_LT(farthest, 1e-5) << hand << ", on the way";
  }
}

TEST(ToolsMeet, KeepTheBalanceOfEnergy) {
  scene::Description d = pressed("sphere", "box");
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  d.integrator.name = "cvode-bdf";
  d.integrator.rtol = 1e-8;
  d.contacts[0].friction = 0.3;
  d.device->keyframes[1].position_m.x() += 0.01;
  HandsFelt both;
  both.weighs = true;
  run(d, both);
  ASSERT_TRUE(both.last);
  EXPECT_GT(both.last->contact, 1e-5);
  EXPECT_LT(std::abs(both.last->unaccounted), 1e-3 * both.last->hand + both.last->quadrature_error);
}

// Each hand's ticks are replayed bitwise from the records of both.
TEST(ToolsMeet, AreReplayedTogether) {
  scene::Description d = pressed("box", "sphere");
  d.record.emplace();
  d.contacts[0].friction = 0.3;
  d.device->keyframes[1].position_m.x() += 0.01;
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "palpate-tools-meet";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const auto world = loop::assemble(d);
  HandsFelt both;
  {
    loop::Recorder recorder(*world, folder.string());
    loop::RunOptions options;
    options.observers = {&both, &recorder};
    ASSERT_TRUE(loop::run(*world, options).status.ok());
  }
  const std::vector<loop::HapticRecord> records = loop::read_haptic_records(folder.string(), d);
  for (const std::size_t hand : {0, 1}) {
    const auto retraced = loop::retrace(d, records, hand);
    ASSERT_EQ(retraced.size(), both.of[hand].size());
    for (std::size_t i = 0; i < retraced.size(); ++i) {
      ASSERT_EQ(retraced[i].device.force, both.of[hand][i].device.force)
          << hand << " at " << retraced[i].time;
      ASSERT_EQ(retraced[i].contact.force, both.of[hand][i].contact.force);
    }
    EXPECT_GT(retraced.back().contact.force.norm(), 0.3);
  }
}

TEST(ToolsMeet, InRealTime) {
  HandsFelt both;
  scene::Description d = pressed("box", "sphere");
  d.duration_s = 0.3;
  run(d, both, true);
  EXPECT_GT(both.of[0].back().contact.force.z(), 0.3);
  EXPECT_LT((both.of[0].back().contact.force + both.of[1].back().contact.force).norm(), 1e-9);
}

TEST(ToolsMeet, WantTicksAtTheSameTimes) {
  scene::Description d = pressed("sphere", "sphere");
  d.hands[0].tool.tick_s = 5e-4;
  try {
    loop::assemble(d);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("\"left\" has tick_s = 0.0005, that of \"tool\" 0.001"),
              std::string::npos)
        << e.what();
  }
  d.contacts.clear();  // without contact between tools, ticks may differ
  HandsFelt both;
  run(d, both);
  EXPECT_EQ(both.of[1].size(), 2 * both.of[0].size());
}

#endif
