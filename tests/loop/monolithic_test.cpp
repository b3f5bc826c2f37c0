#include <gtest/gtest.h>

#include <algorithm>

#include "core/counters.h"
#include "loop/small_scenes.h"
#include "loop/summary.h"
#include "palpate/core/error.h"
#include "palpate/integrate/integrators.h"
#include "palpate/loop/run.h"
#include "summary_rows.h"
#ifdef PALPATE_HAS_TOOL

using namespace palpate;
using namespace palpate::small_scenes;

namespace {

/// The handle moves from first touch to `depth` below it and rests there; tool and block form one system.
scene::Description monolithic_press(double depth) {
  scene::Description d = pressed_block(0.0);
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  KeyframeSpec end = d.device->keyframes.front();
  end.time_s = 0.03;
  end.position_m.z() -= depth;
  d.device->keyframes.push_back(end);
  d.integrator.name = "cvode-bdf";
  d.integrator.rtol = 1e-5;
  return d;
}

class Log : public loop::Observer {
 public:
  void period(loop::World& world, double t) override {
    periods.push_back(t);
    energies.push_back(world.mechanical_energy());
  }
  void tick(const loop::TickRecord& tick) override { ticks.push_back(tick); }
  std::vector<double> periods, energies;
  std::vector<loop::TickRecord> ticks;
};

struct Outcome {
  loop::RunResult result;
  Log log;
  VecX q;
};

Outcome run(const scene::Description& d, double duration = 0.0) {
  Outcome out;
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.observers = {&out.log};
  options.duration_s = duration;
  out.result = loop::run(*world, options);
  out.q = world->state.q();
  return out;
}

TEST(Monolithic, NothingIsExchangedAndNothingCondensed) {
  counters::reset();
  const Outcome out = run(monolithic_press(0.002));
  ASSERT_TRUE(out.result.status.ok()) << out.result.status.message;
  EXPECT_EQ(counters::counter("loop.exchange_record"), 0);
  EXPECT_EQ(counters::counter("loop.condenser"), 0);
  EXPECT_EQ(counters::counter("tool.simbody_system"), 1) << "its right-hand side is Simbody's";
  EXPECT_EQ(out.result.tool_s, 0.0);
  counters::reset();
  scene::Description partitioned = monolithic_press(0.002);
  partitioned.exchange.scheme = scene::ExchangeScheme::kPartitioned;
  ASSERT_TRUE(run(partitioned).result.status.ok());
  EXPECT_EQ(counters::counter("loop.exchange_record"), 4) << "the counters count";
  EXPECT_EQ(counters::counter("loop.condenser"), 0) << "iterations answer a block's contact points";
  counters::reset();
  partitioned.exchange.linearisation = "condensed";
  ASSERT_TRUE(run(partitioned).result.status.ok());
  EXPECT_EQ(counters::counter("loop.condenser"), 1);
}

// The tool's rows are no transpose of its columns, but the nodes' block is symmetric, and keeps its Cholesky
// factor: only six rows are factored by LU. With friction the nodes' block is unsymmetric as well.
TEST(Monolithic, WithoutFrictionStaysOnCholesky) {
  for (const char* integrator : {"cvode-bdf", "ida", "backward-euler"})
    for (const double friction : {0.0, 0.3}) {
      scene::Description d = monolithic_press(0.002);
      d.contacts[0].friction = friction;
      d.integrator.name = integrator;
      d.integrator.step_s = 1e-3;
      d.integrator.linear_solver = "cholmod";
      counters::reset();
      const auto world = loop::assemble(d);
      EXPECT_FALSE(world->system.symmetric());
      const loop::RunResult result = loop::run(*world, {});
      ASSERT_TRUE(result.status.ok()) << result.status.message;
      EXPECT_EQ(counters::counter("integrate.solver.umfpack"), 0) << integrator << friction;
      EXPECT_EQ(counters::counter("integrate.matrices_left_to_lu"), 0) << integrator << friction;
      EXPECT_EQ(result.counters.solver.iterations > 0, friction > 0.0) << integrator;
      d.integrator.linear_solver = "umfpack";
      const auto by_lu = loop::assemble(d);
      const VecX start = by_lu->state.q();
      ASSERT_TRUE(loop::run(*by_lu, {}).status.ok());
      // CVODE's step lengths depend on rounding in its error estimates (ida's do not in this case)
      const double bar = friction > 0.0 && d.integrator.name == "cvode-bdf" ? d.integrator.rtol : 1e-10;
      EXPECT_LT((world->state.q() - by_lu->state.q()).norm(), bar * (by_lu->state.q() - start).norm())
          << integrator << friction;
    }
}

// With one linear solve per step, sliding friction uses its secant, whatever is in the State; Newton's
// iterations use the full tangent.
TEST(Monolithic, LeavesFrictionOutWhereAStepIsOneSolve) {
  for (const bool monolithic : {false, true})
    for (const char* integrator : {"linearly-implicit-euler", "backward-euler"}) {
      scene::Description d = monolithic_press(0.01);
      d.exchange.scheme =
          monolithic ? scene::ExchangeScheme::kMonolithic : scene::ExchangeScheme::kPartitioned;
      d.integrator.name = integrator;
      d.integrator.step_s = 1e-3;
      d.contacts[0].friction = 0.3;
      d.device->keyframes.back().position_m.x() += 0.01;  // it slides
      const auto world = loop::assemble(d);
      ASSERT_TRUE(loop::run(*world, {}).status.ok());
      EXPECT_EQ(world->contact->statistics().largest_lagged_friction > 0.0,
                std::string(integrator) == "linearly-implicit-euler")
          << integrator << monolithic;
    }
}

TEST(Monolithic, SummaryNamesTheSchemeAndNoExchange) {
  const scene::Description d = monolithic_press(0.002);
  const auto world = loop::assemble(d);
  const loop::RunResult result = loop::run(*world, {});
  store::Summary summary = loop::summarise(*world, result, 0.0);
  std::string options;
  for (const auto& [name, value] : summary.section("options").values) options += name + " ";
  EXPECT_NE(options.find("exchange_scheme"), std::string::npos);
  EXPECT_EQ(options.find("exchange_period_s"), std::string::npos) << "there is none";
  bool left_out = false;
  for (const store::SummaryFields& part : summary.list("parts"))
    left_out |= std::get<std::string>(*summary_rows::find(part, "name")) == "exchange" &&
                !std::get<bool>(*summary_rows::find(part, "used"));
  EXPECT_TRUE(left_out);
}

TEST(Monolithic, TicksComeInTheirOrderAndNumberWhateverTheRefresh) {
  for (const double refresh : {0.01, 0.0025, 0.04}) {  // 0.0025: a refresh between two ticks
    scene::Description d = monolithic_press(0.002);
    d.exchange.contact_refresh_s = refresh;
    const Outcome out = run(d);
    ASSERT_TRUE(out.result.status.ok()) << out.result.status.message;
    EXPECT_EQ(out.result.ticks, 40);
    ASSERT_EQ(out.log.ticks.size(), 40u);
    for (std::size_t i = 0; i < out.log.ticks.size(); ++i)
      EXPECT_NEAR(out.log.ticks[i].time, 1e-3 * static_cast<double>(i + 1), 1e-12);
    EXPECT_EQ(out.result.periods, std::lround(0.04 / refresh));
  }
}

// Each sample that closes or opens under the tool is a root at which a step is shortened.
TEST(Monolithic, SummaryCountsTheRootsThatStepsWereCutShortAt) {
  const auto counted = [](KinkTreatment events) {
    scene::Description d = monolithic_press(0.002);
    d.integrator.events = events;
    const auto world = loop::assemble(d);
    const loop::RunResult result = loop::run(*world, {});
    EXPECT_TRUE(result.status.ok()) << result.status.message;
    store::Summary summary = loop::summarise(*world, result, 0.0);
    for (const auto& [name, value] : summary.section("counts").values)
      if (name == "events") return std::pair{std::get<long long>(value), result.counters.events};
    return std::pair{-1LL, -1L};
  };
  const auto [named, events] = counted(KinkTreatment::kRootFinding);
  EXPECT_GT(events, 0);
  EXPECT_EQ(named, events);
  EXPECT_EQ(counted(KinkTreatment::kErrorControl).first, 0);
}

// At rest k (x_h - x_t) + F = 0, as in the partitioned scheme: the two differ in the transient, not in the
// equilibrium.
TEST(Monolithic, RestsWhereThePartitionedSchemeRests) {
  scene::Description d = monolithic_press(0.003);
  const Outcome whole = run(d, 1.5);
  d.exchange.scheme = scene::ExchangeScheme::kPartitioned;
  const Outcome parts = run(d, 1.5);
  ASSERT_TRUE(whole.result.status.ok() && parts.result.status.ok());
  const loop::TickRecord &a = whole.log.ticks.back(), &b = parts.log.ticks.back();
  ASSERT_GT(a.contact.force.z(), 0.05);
  const Vec3 spring = d.tool->coupling.stiffness_n_m * (a.handle.translation - a.tool.translation);
  EXPECT_LT((spring + a.contact.force).norm(), 1e-5 * a.contact.force.norm());
  EXPECT_LT((a.tool.translation - b.tool.translation).norm(), 1e-3 * 0.003);
  EXPECT_LT((a.device.force - b.device.force).norm(), 1e-3 * b.device.force.norm());
}

// Without damping, with the handle at rest and one contact query, the sum of kinetic, elastic, contact and
// coupling energy is conserved, while far more than the tolerance is exchanged between tool and block.
TEST(Monolithic, ToolAndBodiesKeepTheirEnergyTogether) {
  scene::Description d = pressed_block(0.003);
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  d.exchange.contact_refresh_s = 0.002;
  d.record.emplace();
  d.bodies[0].stiffness_damping_s = 0.0;
  d.tool->coupling.damping_n_s_m = d.tool->coupling.rotational_damping_n_m_s_rad = 0.0;
  d.integrator.name = "cvode-bdf";
  d.integrator.rtol = 1e-8;
  d.duration_s = 0.002;  // until the next query
  const auto world = loop::assemble(d);
  world->contact->refresh(world->state.view());
  const double before = world->mechanical_energy(),
               elastic_before = world->bodies[0].term->energy(world->state.view());
  const auto status = world->stepper->advance_to(0.02);
  ASSERT_TRUE(status.ok()) << status.message;
  const double elastic = world->bodies[0].term->energy(world->state.view());
  EXPECT_GT(std::abs(elastic - elastic_before), 1e-2 * before) << "energy went into the block";
  EXPECT_NEAR(world->mechanical_energy() / before, 1.0, 1e-5);
}

// One tool with two independent integrators: CVODE on the block of the State, and Simbody's Merson on a
// separate System.
TEST(Monolithic, AToolAloneMovesAsInASystemOfItsOwn) {
  scene::Description d = monolithic_press(0.02);
  d.bodies.clear();
  d.contacts.clear();
  d.tool->gravity = true;
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  d.device->keyframes.back().rotation_vector_rad = Vec3(0.3, 0.5, -0.2);
  d.integrator.rtol = 1e-9;
  const Outcome whole = run(d);
  d.exchange.scheme = scene::ExchangeScheme::kPartitioned;
  d.tool->integrator = "simbody-rkmerson";
  const Outcome parts = run(d);
  ASSERT_TRUE(whole.result.status.ok()) << whole.result.status.message;
  ASSERT_EQ(whole.log.ticks.size(), parts.log.ticks.size());
  for (std::size_t i = 0; i < whole.log.ticks.size(); ++i)
    EXPECT_LT(pose_difference(whole.log.ticks[i].tool, parts.log.ticks[i].tool).norm(), 1e-6) << "tick " << i;
}

// An integrator of bodies also integrates a tool: its block's unit quaternion, the border of the Newton
// matrix. All integrators of the registry, against cvode-bdf at rtol 1e-8, over the first 20 ms of a press:
// the tool touches at once and is 0.6 mm deep at the end.
class MonolithicRegistry : public testing::TestWithParam<std::string> {};

std::vector<std::string> moving_integrators() {
  std::vector<std::string> out;
  for (const auto& entry : integrate::stepper_registry())
    if (entry.traits.stability != dynamics::Stability::kStatic) out.push_back(entry.name);
  return out;
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
  std::string out = info.param;
  std::replace(out.begin(), out.end(), '-', '_');
  return out;
}

INSTANTIATE_TEST_SUITE_P(Registry, MonolithicRegistry, testing::ValuesIn(moving_integrators()), test_name);

TEST_P(MonolithicRegistry, StepsToolAndBodiesAsOneSystem) {
  constexpr double kDuration = 0.02;
  scene::Description d = monolithic_press(0.002);
  d.integrator.rtol = 1e-8;
  static const Outcome reference = run(d, kDuration);
  ASSERT_TRUE(reference.result.status.ok()) << reference.result.status.message;
  ASSERT_GT(reference.log.ticks.back().contact.force.z(), 0.01) << "they touch";
  const double moved = (reference.log.ticks.back().tool.translation - d.tool->position_m).norm();

  const dynamics::StepperTraits traits = find(integrate::stepper_registry(), GetParam(), "integrator").traits;
  const bool fixed = traits.control == dynamics::StepControl::kFixed;
  d.integrator.name = GetParam();
  d.integrator.rtol = 1e-5;  // relative to the tool's radius, 15 mm: 2e-4 of its displacement
  // explicit: below its stability limit
  d.integrator.step_s = traits.stability == dynamics::Stability::kExplicit ? 2e-5 : 2e-4;
  const Outcome out = run(d, kDuration);
  ASSERT_TRUE(out.result.status.ok()) << out.result.status.message;
  ASSERT_EQ(out.log.ticks.size(), reference.log.ticks.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < reference.log.ticks.size(); ++i)
    worst =
        std::max(worst, (out.log.ticks[i].tool.translation - reference.log.ticks[i].tool.translation).norm());
  RecordProperty("error", std::to_string(worst / moved));
  // Order 1: an error of h times a rate, sqrt(k/m) = 77/s of the coupling, times a small factor. Higher
  // order, or error control: the error of the kink at first touch.
  EXPECT_LT(worst, (fixed && traits.order == 1 ? 2e-2 : 1e-3) * moved);
  EXPECT_NEAR(out.q.tail<7>().head<4>().norm(), 1.0, 1e-12);
}

}  // namespace
#endif
