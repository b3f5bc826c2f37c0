// Force on the hand, compared with the monolithic solution of tool and bodies.
#include "experiments/compare/haptic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "experiments/compare/haptic_plan.h"
#include "experiments/compare/monolithic.h"
#include "experiments/compare/scenes.h"
#include "loop/haptic_memory.h"
#include "palpate/core/error.h"
#include "store/csv.h"
#include "temporary_folder.h"

using namespace palpate;
using compare::HapticComparison;
using compare::HapticPoint;
using compare::Status;

namespace {

HapticComparison compare_here(const scene::Description& description, const compare::CompareOptions& options) {
  experiments::ResultStore store;
  if (!options.folder.empty()) store = experiments::ResultStore::here(options.folder, false);
  experiments::EngineOutcome outcome;
  return compare::compare_haptic(description, options, {&store}, outcome);
}

/// A round tool presses a block of 160 tetrahedra while the handle moves down and turns, which gives force
/// and torque. The coupling has w = sqrt(k/m) = 77/s: a period of 2 ms is 0.15 rad of its phase.
const std::string kPress = compare_scenes::touch_text(
    "0.035", "tick_s = 2e-4\n", "rotational_stiffness_n_m_rad = 0.02\nrotational_damping_n_m_s_rad = 3e-4\n",
    R"([[device.keyframe]]
time_s = 0.08
position_m = [0.001, 0.002, 0.031]
rotation_vector_rad = [0.1, 0.2, 0.3]
[exchange]
exchange_period_s = 2e-3
[integrator]
name = "cvode-bdf"
rtol = 1e-3
)");
constexpr const char* kVaried = R"([compare.haptic]
reference_rtol = 1e-7
reference_refresh_s = 2.5e-4
exchange_periods_s = [2e-3, 1e-3, 5e-4]
ticks_s = [1e-3, 2e-4]
integrators = ["linearly-implicit-euler"]
)";

scene::Description press(const std::vector<std::string>& overrides = {}) {
  return loop::parse(kPress + kVaried, "press.toml", overrides);
}

compare::CompareOptions once() {
  compare::CompareOptions options;
  options.repeats = 1;
  options.limit_s = options.reference_limit_s = 300.0;
  return options;
}

const HapticPoint& point_of(const HapticComparison& c, const char* variable, double setting) {
  for (const HapticPoint& p : c.points)
    if (p.variable == variable && std::abs(p.setting - setting) < 1e-9) return p;
  throw std::runtime_error(std::string("no point of ") + variable);
}

const HapticPoint& own_point(const HapticComparison& c) {
  for (const HapticPoint& p : c.points)
    if (p.own) return p;
  throw std::runtime_error("no point of the scene's own");
}

// Comparison over all variables, computed once; the tests below check its parts.
const HapticComparison& measured() {
  static const HapticComparison comparison = compare_here(press(), once());
  return comparison;
}

TEST(Haptic, TheErrorFallsWithThePeriodAtOrderOne) {
  const HapticComparison& c = measured();
  EXPECT_EQ(c.reference.trouble, "");
  EXPECT_GT(c.peak_force_n, 0.1);
  ASSERT_EQ(c.orders.size(), 3u);
  const compare::HapticOrder& alone = c.orders[1];
  EXPECT_EQ(alone.variable, "exchange alone");
  EXPECT_EQ(alone.force_points, 3);
  EXPECT_EQ(alone.torque_points, 3);
  for (const double order : {alone.force, alone.torque}) {
    EXPECT_GT(order, 0.85);
    EXPECT_LT(order, 2.2);
  }
  const HapticPoint &coarse = point_of(c, "exchange alone", 2e-3),
                    &fine = point_of(c, "exchange alone", 5e-4);
  EXPECT_LT(fine.error.force_rms_n, 0.5 * coarse.error.force_rms_n);
  EXPECT_LE(fine.error.force_rms_n, fine.error.force_max_n);
  EXPECT_LT(own_point(c).error.force_rms_n, 0.05 * c.peak_force_n);
}

TEST(Haptic, EveryVariableHasTheScenesOwnOnceAndEveryName) {
  const HapticComparison& c = measured();
  std::map<std::string, int> own;
  std::map<std::string, std::set<std::string>> values;
  for (const HapticPoint& p : c.points) {
    own[p.variable] += p.own;
    EXPECT_TRUE(values[p.variable].insert(p.value).second) << p.variable << ": " << p.value << " twice";
  }
  for (const char* variable : {"exchange period", "tick", "integrator", "scheme", "linearisation"})
    EXPECT_EQ(own[variable], 1) << variable;
  EXPECT_EQ(own["exchange alone"], 0);
  EXPECT_EQ(values["integrator"], (std::set<std::string>{"cvode-bdf", "linearly-implicit-euler"}));
  EXPECT_TRUE(values["scheme"].contains("single_rate"));
  for (const char* name : {"condensed", "frozen"}) EXPECT_TRUE(values["linearisation"].contains(name));
  EXPECT_FALSE(values.contains("pixels")) << "a sphere's gaps are exact";
  EXPECT_FALSE(values.contains("element size")) << "nobody asked for it";
  for (const HapticPoint& p : c.points) {
    if (p.status != Status::kOk) continue;
    EXPECT_GT(p.cpu_median_s, 0.0);
    EXPECT_TRUE(std::isfinite(p.error.force_rms_n)) << p.variable << ": " << p.value;
    EXPECT_GT(p.bodies_s(), 0.0);
  }
}

// 0.5 ms is no multiple of a tick of 0.2 ms, so that the loader rejects this point.
TEST(Haptic, WhatTheLoaderRefusesIsARowAndEndsNothingElse) {
  const HapticPoint& p = point_of(measured(), "exchange period", 5e-4);
  EXPECT_EQ(p.status, Status::kRefused);
  EXPECT_NE(p.reason.find("tick"), std::string::npos) << p.reason;
  EXPECT_TRUE(std::isnan(p.error.force_rms_n));
  EXPECT_EQ(point_of(measured(), "exchange period", 1e-3).status, Status::kOk);
}

TEST(Haptic, PixelsAreVariedWhereTheToolIsSeenInAnImage) {
  const auto points = compare::plan_haptic(press({"contact.0.method=image", "compare.haptic.pixels=[32, 64]",
                                                  "compare.haptic.element_sizes_m=[0.02]"}),
                                           {});
  int pixels = 0, elements = 0;
  for (const HapticPoint& p : points) {
    elements += p.variable == "element size";
    if (p.variable != "pixels") continue;
    ++pixels;
    EXPECT_EQ(p.description.contacts[0].pixels, std::lround(p.setting));
  }
  EXPECT_EQ(pixels, 2);
  EXPECT_EQ(elements, 2) << "that of the list and the scene's own";
}

TEST(Haptic, TheReferenceIsOneSystemAndItsCheckIsCoarserAndOfAnotherFamily) {
  const scene::Description d = press({"exchange.latency_ticks=5", "integrator.rtol=1e-2"});
  const compare::MonolithicScene fine = compare::monolithic_scene(d),
                                 coarse = compare::monolithic_scene(d, 2.0);
  EXPECT_EQ(fine.description.exchange.scheme, scene::ExchangeScheme::kMonolithic);
  EXPECT_EQ(fine.description.exchange.latency_ticks, 0);
  EXPECT_DOUBLE_EQ(fine.description.exchange.contact_refresh_s, 2.5e-4);
  EXPECT_DOUBLE_EQ(fine.description.integrator.rtol, 1e-7);
  EXPECT_DOUBLE_EQ(coarse.description.exchange.contact_refresh_s, 5e-4);
  EXPECT_NEAR(coarse.description.integrator.rtol, 1e-6, 1e-12);
  EXPECT_EQ(coarse.description.integrator.name, "ark-dirk-esdirk437");
  EXPECT_NE(coarse.description.integrator.linear_solver, fine.description.integrator.linear_solver);
  EXPECT_NE(fine.made_by.find("cvode-bdf at rtol 1e-07"), std::string::npos) << fine.made_by;
  const compare::MonolithicScene steps = compare::monolithic_scene(
      press({"compare.haptic.reference=implicit-midpoint", "compare.haptic.reference_step_s=1e-4"}));
  EXPECT_DOUBLE_EQ(steps.description.integrator.step_s, 1e-4);
  const auto check_of = [](const std::vector<std::string>& set) {
    return compare::monolithic_scene(press(set), 2.0).description.integrator;
  };
  const IntegratorSpec check =
      check_of({"compare.haptic.reference=implicit-midpoint", "compare.haptic.reference_step_s=1e-4"});
  EXPECT_EQ(check.name, "generalized-alpha");
  EXPECT_DOUBLE_EQ(check.step_s, 2e-4);
  EXPECT_EQ(check_of({"compare.haptic.reference_check=ark-dirk-trbdf2"}).name, "ark-dirk-trbdf2");
  EXPECT_EQ(check_of({"compare.haptic.reference=ark-dirk-trbdf2"}).name, "cvode-bdf");
  EXPECT_THROW(check_of({"compare.haptic.reference_check=ida"}), Error) << "backward differences as well";
}

const HapticPoint& frozen_point(const HapticComparison& c) {
  for (const HapticPoint& p : c.points)
    if (p.variable == "linearisation" && p.value == "frozen") return p;
  throw std::runtime_error("no point of frozen");
}

// A frozen contact lags the body's motion by half a period on average, plus the delay, which here is another
// half period.
TEST(Haptic, ADelayIsSeen) {
  const scene::Description late =
      press({"exchange.linearisation=frozen", "exchange.latency_ticks=5",
             "compare.haptic.exchange_periods_s=[2e-3]", "compare.haptic.ticks_s=[2e-4]",
             "compare.haptic.integrators=[]", "compare.haptic.linearisations=[\"frozen\"]"});
  const HapticComparison c = compare_here(late, once());
  EXPECT_GT(own_point(c).error.force_rms_n, 1.5 * frozen_point(measured()).error.force_rms_n);
}

HapticPoint fabricated(double setting, double force, double torque) {
  HapticPoint p;
  p.variable = "exchange period";
  p.setting = setting;
  p.status = Status::kOk;
  p.error.force_rms_n = force;
  p.error.torque_rms_n_m = torque;
  return p;
}

// Errors h and h^2 at known points; the finest force is below the reference error, and the coarsest is wrong
// throughout.
TEST(Haptic, OrdersLeaveOutWhatIsNotResolvedAndWhatIsWrongThroughout) {
  HapticComparison c;
  c.peak_force_n = c.peak_torque_n_m = 1.0;
  compare::TrajectoryError own;
  own.force_rms_n = 1e-3;
  own.torque_rms_n_m = 1e-9;
  c.points = {fabricated(0.2, 0.9, 0.04), fabricated(0.08, 0.08, 0.0064), fabricated(0.02, 0.02, 4e-4),
              fabricated(0.01, 0.0099, 1e-4)};
  for (HapticPoint& p : c.points) compare::summarise(p, own);
  EXPECT_FALSE(c.points[2].force_unresolved);
  EXPECT_TRUE(c.points[3].force_unresolved) << "9.9 times the reference's own error";
  EXPECT_FALSE(c.points[3].torque_unresolved);
  const std::vector<compare::HapticOrder> orders = compare::haptic_orders(c);
  EXPECT_EQ(orders[0].force_points, 2);
  EXPECT_NEAR(orders[0].force, 1.0, 1e-12);
  EXPECT_EQ(orders[0].torque_points, 4);
  EXPECT_NEAR(orders[0].torque, 2.0, 1e-12);
  EXPECT_TRUE(std::isnan(orders[1].force)) << "no points, no order";
  c.peak_torque_n_m = 1e-13;
  EXPECT_EQ(compare::haptic_orders(c)[0].torque_points, 0) << "no torque but rounding";
  HapticPoint failed = fabricated(0.1, NAN, NAN);
  compare::summarise(failed, own);
  EXPECT_FALSE(failed.force_unresolved || failed.torque_unresolved);
}

TEST(Haptic, GoesOnFromItsDatabaseAndWritesOneRowAPoint) {
  const TemporaryFolder folder;
  compare::CompareOptions options = once();
  options.folder = folder.string();
  const scene::Description d =
      press({"scene.duration_s=0.01", "compare.haptic.exchange_periods_s=[2e-3, 3e-4]",
             "compare.haptic.integrators=[]", "compare.haptic.linearisations=[\"frozen\"]",
             "compare.haptic.reference_rtol=1e-4", "compare.haptic.ticks_s=[]"});
  const HapticComparison first = compare_here(d, options);
  EXPECT_EQ(first.reused, 0);
  const HapticComparison again = compare_here(d, options);
  EXPECT_EQ(again.reused, 2 + 5) << "reference, check, the scene's own, two alone, single-rate, frozen";
  EXPECT_EQ(own_point(again).error.force_rms_n, own_point(first).error.force_rms_n);
  compare::write(again, folder.string());
  const store::CsvTable table = store::read_csv((folder / "haptic.csv").string());
  EXPECT_EQ(table.rows.size(), again.points.size());
  EXPECT_DOUBLE_EQ(table.numbers("force_error_rms_of_peak")[0],
                   own_point(again).error.force_rms_n / again.peak_force_n);
}

std::string refusal(const scene::Description& d) {
  try {
    compare_here(d, once());
  } catch (const Error& e) { return e.what(); }
  return "accepted";
}

TEST(Haptic, RefusesAScene) {
  EXPECT_NE(refusal(compare_scenes::block("")).find("there is no [tool]"), std::string::npos);
  EXPECT_NE(refusal(compare_scenes::tool_only()).find("there is no [[body]]"), std::string::npos);
  EXPECT_NE(refusal(press({"exchange.scheme=monolithic"})).find("is the reference itself"),
            std::string::npos);
  EXPECT_NE(refusal(press({"compare.haptic.reference=kinsol"})).find("kinsol"), std::string::npos);
}

TEST(Haptic, StopsAtOnceWhenAsked) {
  std::atomic<bool> stop{true};
  compare::CompareOptions options = once();
  options.stop = &stop;
  const HapticComparison c = compare_here(press(), options);
  EXPECT_TRUE(c.stopped);
  EXPECT_EQ(own_point(c).status, Status::kMissing);
}

/// Runs the faulty scene and compares it with the monolithic solution of the scene without the fault.
compare::AgainstReference against(const scene::Description& faulty, bool real_time = false) {
  const auto world = loop::assemble(faulty);
  loop::HapticMemory memory;
  loop::RunOptions options;
  options.observers = {&memory};
  EXPECT_TRUE(loop::run(*world, options).status.ok());
  world->description = press();
  return compare::against_monolithic(*world, memory.records(), real_time, {}, nullptr);
}

TEST(Haptic, ARunIsHeldAgainstItsOwnSceneAsOneSystem) {
  const compare::AgainstReference good = against(press());
  EXPECT_EQ(good.trouble, "");
  EXPECT_FALSE(good.recorded_hand);
  EXPECT_NEAR(good.error.force_rms_n, own_point(measured()).error.force_rms_n, 1e-6);
  EXPECT_NEAR(good.peak_force_n, measured().peak_force_n, 1e-6);
  EXPECT_LT(good.error.force_rms_n, 0.05 * good.peak_force_n);
  for (const char* fault :
       {"tool.coupling.damping_n_s_m=1.0", "contact.0.stiffness_pa_m=2e6", "tool.mass_kg=0.1"}) {
    const compare::AgainstReference bad = against(press({fault}));
    EXPECT_GT(bad.error.force_rms_n, 1.5 * good.error.force_rms_n) << fault;
  }
}

// The recorded hand, tick by tick, equals the scripted one to well within the measured error.
TEST(Haptic, ARealTimeRunIsHeldByItsRecordedHand) {
  const compare::AgainstReference script = against(press()), recorded = against(press(), true);
  EXPECT_EQ(recorded.trouble, "");
  EXPECT_TRUE(recorded.recorded_hand);
  EXPECT_NEAR(recorded.error.force_rms_n, script.error.force_rms_n, 0.02 * script.error.force_rms_n);
}

}  // namespace
