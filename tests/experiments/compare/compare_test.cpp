// Comparisons of integrators on small scenes: their sequences of settings, linear solvers and references, and
// the benchmarks of the product.
#include "palpate/experiments/compare.h"

#include <gtest/gtest.h>

#include "experiments/compare/scenes.h"
#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "product/bench.h"
#include "validation.h"

using namespace palpate;
using compare::Status;
using compare_scenes::quick;

namespace {

std::string message_of(const scene::Description& d, const compare::CompareOptions& options) {
  try {
    compare::run({d}, options);
  } catch (const Error& e) { return e.what(); }
  return "";
}

TEST(Compare, FindsTheOrderOfTheoryAgainstAReferenceOfAnotherFamily) {
  compare::CompareOptions options = quick();
  options.repeats = 2;
  int calls = 0;
  options.progress = [&](double fraction, const std::string& what) {
    ++calls;
    EXPECT_LE(fraction, 1.0);
    EXPECT_FALSE(what.empty());
  };
  const compare::Comparison all = compare::run({compare_scenes::block(compare_scenes::kLadders)}, options);
  ASSERT_EQ(all.scenes.size(), 1u);
  const compare::SceneComparison& c = all.scenes[0];
  EXPECT_LT(c.reference.own_error.position_rel_l2, 1e-6);
  EXPECT_EQ(c.reference.trouble, "");
  EXPECT_NE(c.reference.description.find("ark-erk-5"), std::string::npos);
  ASSERT_EQ(c.points.size(), 6u);
  EXPECT_EQ(calls, 2 + 2 * 6);
  std::vector<double> h, e;
  for (const compare::ComparePoint& p : c.points) {
    EXPECT_EQ(p.cpu_s.size(), 2u);
    EXPECT_LE(p.cpu_min_s, p.cpu_median_s);
    EXPECT_EQ(p.status, Status::kOk) << p.reason;
    EXPECT_FALSE(p.family.empty());
    if (p.integrator != "linearly-implicit-euler") continue;
    h.push_back(p.setting);
    e.push_back(p.error.position_rel_l2);
  }
  const double order = validation::fitted_order(h, e);
  EXPECT_GT(order, 0.9);
  EXPECT_LT(order, 1.1);
  EXPECT_LT(c.points.back().error.position_rel_l2, 1e-4);
}

TEST(Compare, SeveralScenesEachAgainstItsOwnReference) {
  compare::CompareOptions options = quick();
  options.integrators = {"cvode-bdf"};
  options.jobs = 2;
  const auto soft = compare_scenes::block(compare_scenes::kLadders, "soft"),
             stiff = compare_scenes::block(compare_scenes::kLadders, "stiff", 4e4);
  const compare::Comparison all = compare::run({soft, stiff}, options);
  ASSERT_EQ(all.scenes.size(), 2u);
  EXPECT_EQ(all.scenes[1].scene, "stiff");
  for (const compare::SceneComparison& c : all.scenes) {
    ASSERT_EQ(c.points.size(), 3u);
    EXPECT_LT(c.points[2].error.position_rel_l2, 1e-4);
  }
  EXPECT_NE(all.scenes[0].points[0].error.position_rel_l2, all.scenes[1].points[0].error.position_rel_l2);
  const auto alone = compare::run({soft}, options);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(alone.scenes[0].points[i].error.position_rel_l2, all.scenes[0].points[i].error.position_rel_l2);
}

// Without a refinement sequence in the scene, each integrator gets one that varies the quantity that controls
// its step; no list of integrators is needed.
TEST(Compare, ComparesWhatTheSceneDoesNotName) {
  compare::CompareOptions options = quick();
  options.limit_s = 1.0;
  const compare::SceneComparison c = compare::run({compare_scenes::block("")}, options).scenes[0];
  int rtol = 0, step = 0;
  for (const compare::ComparePoint& p : c.points) {
    rtol += p.integrator == "cvode-bdf" && p.setting_name == "rtol";
    step += p.integrator == "linearly-implicit-euler" && p.setting_name == "step_s";
  }
  EXPECT_GE(rtol, 7);
  EXPECT_GE(step, 6);
  EXPECT_DOUBLE_EQ(c.points.front().setting, 1e-1);
  EXPECT_TRUE(c.points.front().coarsest);
  EXPECT_FALSE(c.points[1].coarsest);
  for (std::size_t i = 1; i < c.points.size(); ++i) {
    if (c.points[i].label != c.points[i - 1].label) continue;
    EXPECT_NEAR(c.points[i].setting / c.points[i - 1].setting, c.points[i].setting_name == "rtol" ? 0.1 : 0.5,
                1e-12);
  }
}

TEST(Compare, LaddersOfOneIntegratorAreToldApartByTheirLabels) {
  compare::CompareOptions options = quick();
  options.integrators = {"capped at 2"};
  const std::string labelled = compare_scenes::kLadders +
                               "[[compare.ladder]]\nintegrator = \"cvode-bdf\"\nlabel = \"capped at 2\"\nset "
                               "= [\"integrator.max_order=2\"]\nrtol = [1e-4]\n";
  compare::SceneComparison c = compare::run({compare_scenes::block(labelled)}, options).scenes[0];
  ASSERT_EQ(c.points.size(), 1u);
  EXPECT_EQ(c.points[0].label, "capped at 2");
  EXPECT_EQ(c.points[0].description.integrator.max_order, 2);
  const long capped = c.points[0].result.counters.steps;
  options.integrators = {"cvode-bdf"};  // that sequence only, not those with another label
  c = compare::run({compare_scenes::block(labelled)}, options).scenes[0];
  ASSERT_EQ(c.points.size(), 3u);
  for (const auto& point : c.points) EXPECT_EQ(point.label, "cvode-bdf");
  EXPECT_LT(c.points[1].result.counters.steps, capped) << "of order 5 it needs fewer steps at rtol 1e-4";
}

const compare::ComparePoint& point_of(const compare::SceneComparison& c, const std::string& label) {
  for (const compare::ComparePoint& p : c.points)
    if (p.label == label) return p;
  throw std::runtime_error("no point of " + label);
}

const std::string kOneRung = R"([integrator]
linear_solver = "umfpack"
[[compare.ladder]]
integrator = "linearly-implicit-euler"
step_s = [1e-3]
[[compare.ladder]]
integrator = "ark-dirk-sdirk212"
rtol = [1e-3]
[[compare.ladder]]
integrator = "ark-erk-3"
rtol = [1e-3]
[compare]
reference_rtol = 1e-6
reference_check_rtol = 1e-6
)";

compare::CompareOptions one_rung() {
  compare::CompareOptions options;
  options.repeats = 1;
  options.integrators = {"linearly-implicit-euler", "ark-dirk-sdirk212", "ark-erk-3"};
  return options;
}

// All methods are compared with the same linear solver, whatever their defaults are.
TEST(Compare, AllMethodsHaveOneLinearSolver) {
  const auto d = compare_scenes::block(kOneRung);
  compare::CompareOptions options = one_rung();
  const compare::SceneComparison same = compare::run({d}, options).scenes[0];
  EXPECT_EQ(point_of(same, "linearly-implicit-euler").linear_solver, "cholmod");
  EXPECT_EQ(point_of(same, "ark-dirk-sdirk212").linear_solver, "cholmod");
  EXPECT_EQ(point_of(same, "ark-erk-3").linear_solver, "") << "it solves none";
  EXPECT_EQ(point_of(same, "linearly-implicit-euler").result.counters.solver.iterations, 0);
  options.linear_solver = "pcg";
  const compare::SceneComparison iterative = compare::run({d}, options).scenes[0];
  EXPECT_GT(point_of(iterative, "linearly-implicit-euler").result.counters.solver.iterations, 0);
  EXPECT_GT(point_of(iterative, "ark-dirk-sdirk212").result.counters.solver.iterations, 0);
  options.linear_solvers = compare::LinearSolvers::kNamed;
  const compare::SceneComparison named = compare::run({d}, options).scenes[0];
  EXPECT_EQ(point_of(named, "ark-dirk-sdirk212").linear_solver, "umfpack");
  EXPECT_EQ(point_of(named, "ark-dirk-sdirk212").result.counters.solver.iterations, 0);
}

double direct_error(const compare::SceneComparison& c, const std::string& label) {
  for (const compare::ComparePoint& trial : c.trials)
    if (trial.label == label + " by cholmod") return trial.error.position_rel_l2;
  return 0.0;
}

TEST(Compare, EachMethodsBestLinearSolverIsFoundByTrying) {
  compare::CompareOptions options = one_rung();
  options.linear_solvers = compare::LinearSolvers::kBest;
  const compare::SceneComparison c = compare::run({compare_scenes::block(kOneRung)}, options).scenes[0];
  EXPECT_EQ(c.trials.size(), 6u) << "three solvers of two implicit methods";
  for (const char* label : {"linearly-implicit-euler", "ark-dirk-sdirk212"}) {
    const compare::ComparePoint* best = nullptr;
    for (const compare::ComparePoint& trial : c.trials) {
      EXPECT_EQ(trial.status, Status::kOk) << trial.label << ": " << trial.reason;
      const double right = direct_error(c, label);
      EXPECT_GT(right, 0.0);
      if (trial.error.position_rel_l2 > 2.0 * right) continue;  // fast but inaccurate
      if (trial.label.starts_with(label) && (!best || trial.cpu_median_s < best->cpu_median_s)) best = &trial;
    }
    ASSERT_TRUE(best);
    EXPECT_EQ(point_of(c, label).linear_solver, best->linear_solver);
  }
}

// A method's error does not show what it shares with its reference: each method is compared with a
// reference of the other family.
TEST(Compare, NoMethodIsHeldAgainstItsOwnFamily) {
  const compare::SceneComparison c =
      compare::run({compare_scenes::block(compare_scenes::kLadders)}, quick()).scenes[0];
  EXPECT_EQ(point_of(c, "cvode-bdf").against, "ark-erk-5");
  EXPECT_EQ(point_of(c, "linearly-implicit-euler").against, "cvode-bdf");
}

// An implicit check also uses another factorisation than the reference.
TEST(Compare, AReferenceIsCheckedByAnotherFactorisation) {
  const compare::SceneComparison c =
      compare::run({compare_scenes::block(kOneRung + "reference_check = \"ark-dirk-esdirk547\"\n")},
                   one_rung())
          .scenes[0];
  EXPECT_NE(c.reference.description.find("cvode-bdf at rtol 1e-06 by umfpack, checked against "
                                         "ark-dirk-esdirk547 at rtol 1e-06 by cholmod"),
            std::string::npos)
      << c.reference.description;
  EXPECT_EQ(point_of(c, "ark-dirk-sdirk212").against, "cvode-bdf");
}

// A default refinement sequence ends at the first levels that the reference cannot resolve.
TEST(Compare, ALadderWithoutRungsEndsWhereTheReferenceDoes) {
  compare::CompareOptions options = quick();
  options.integrators = {"ark-dirk-esdirk437"};
  const std::string text =
      "[[compare.ladder]]\nintegrator = \"ark-dirk-esdirk437\"\n[compare]\nreference_rtol = "
      "1e-8\nreference_check_rtol = 1e-8\n";
  const compare::SceneComparison c = compare::run({compare_scenes::block(text)}, options).scenes[0];
  ASSERT_GE(c.points.size(), 3u);
  EXPECT_LT(c.points.size(), 12u);
  for (std::size_t i = 0; i < c.points.size(); ++i) {
    EXPECT_EQ(c.points[i].status, Status::kOk) << c.points[i].reason;
    EXPECT_EQ(c.points[i].unresolved, i + 2 >= c.points.size()) << i;
  }
}

TEST(Compare, LaddersThatMakeNoSenseAreRefused) {
  const auto with = [](const std::string& ladder) {
    return compare_scenes::block("[[compare.ladder]]\n" + ladder);
  };
  compare::CompareOptions everything;
  everything.repeats = 1;
  EXPECT_NE(
      message_of(with("integrator = \"cvode-bdf\"\nstep_s = [0.01]\n"), everything).find("has error control"),
      std::string::npos);
  EXPECT_NE(message_of(with("integrator = \"linearly-implicit-euler\"\nrtol = [0.01]\n"), everything)
                .find("takes fixed steps"),
            std::string::npos);
  EXPECT_NE(message_of(with("integrator = \"cvode-bfd\"\nrtol = [0.01]\n"), everything)
                .find("did you mean \"cvode-bdf\"?"),
            std::string::npos);
  const std::string twice = "integrator = \"cvode-bdf\"\nrtol = [0.01]\n";
  EXPECT_NE(
      message_of(with(twice + "[[compare.ladder]]\n" + twice), everything).find("give one of them a label"),
      std::string::npos);
  EXPECT_NE(message_of(
                with("integrator = \"rk4\"\nset = [\"integrator.linear_solver=cholmod\"]\nstep_s = [1e-4]\n"),
                everything)
                .find("linear_solver does not apply to integrator \"rk4\""),
            std::string::npos);
  compare::CompareOptions unknown = quick();
  unknown.integrators = {"cvode-bfd"};
  EXPECT_NE(message_of(compare_scenes::block(""), unknown).find("did you mean \"cvode-bdf\"?"),
            std::string::npos);
  scene::Description made_by_hand = small_scenes::held_block();
  EXPECT_NE(message_of(made_by_hand, quick()).find("has no text"), std::string::npos);
}

// A run's process receives the scene as text: the text must reproduce the scene bitwise.
TEST(Compare, TheTextOfASceneIsAllOfIt) {
  const scene::Description d =
      loop::parse(compare_scenes::block_text(compare_scenes::kLadders), "block.toml",
                  {"body.0.youngs_modulus_pa=12345.678901234567", "integrator.rtol=1.2345678901234567e-7",
                   "scene.gravity_m_s2=[0.1, 1e-300, -0.30000000000000004]", "integrator.name=cvode-bdf",
                   "integrator.max_order=2"});
  const scene::Description again = loop::parse(d.source, d.path);
  EXPECT_EQ(again.source, d.source);
  EXPECT_EQ(again.bodies[0].youngs_modulus_pa, 12345.678901234567);
  EXPECT_EQ(again.integrator.rtol, 1.2345678901234567e-7);
  EXPECT_EQ(again.integrator.max_order, 2);
  EXPECT_EQ(again.gravity_m_s2, Vec3(0.1, 1e-300, -0.30000000000000004));
  EXPECT_EQ(again.compare.ladders[1].values, d.compare.ladders[1].values);
}

#ifdef PALPATE_HAS_TOOL
// Each of Simbody's schemes converges at its order in the tick; the error-controlled methods depend on the
// tick only through the handle, which is sampled once per tick.
TEST(Compare, AToolWithoutABodyIsComparedByItsTicks) {
  compare::CompareOptions options;
  options.repeats = 1;
  const compare::SceneComparison c = compare::run({compare_scenes::tool_only()}, options).scenes[0];
  EXPECT_EQ(c.reference.trouble, "");
  EXPECT_LT(c.reference.own_error.position_rel_l2, 1e-6);
  std::vector<double> h, e;
  int cpodes = 0;
  for (const compare::ComparePoint& p : c.points) {
    EXPECT_EQ(p.status, Status::kOk) << p.label << ": " << p.reason;
    EXPECT_EQ(p.setting_name, "tick_s");
    cpodes += p.integrator == "simbody-cpodes";
    if (p.integrator != "linearly-implicit-euler") continue;
    h.push_back(p.setting);
    e.push_back(p.error.position_rel_l2);
  }
  EXPECT_EQ(cpodes, 6);
  ASSERT_EQ(h.size(), 6u);
  const double order = validation::fitted_order({h.begin() + 2, h.end()}, {e.begin() + 2, e.end()});
  EXPECT_GT(order, 0.9);
  EXPECT_LT(order, 1.1);
}

// A multistep method restarts at every refresh that changes the contact, and so needs more steps the more
// often contact is refreshed; the step count of a one-step method does not change.
TEST(Compare, RestartsCostMultistepMethods) {
  const std::string text = R"([scene]
name = "falling block"
duration_s = 0.04
gravity_m_s2 = [0.0, 0.0, -9.81]
[[body]]
name = "block"
position_m = [0.0, 0.0, 0.0101]
velocity_m_s = [0.0, 0.0, -0.5]
youngs_modulus_pa = 2e4
stiffness_damping_s = 2e-3
[body.mesh]
generator = "box"
size_m = [0.04, 0.04, 0.02]
element_size_m = 0.01
[[obstacle]]
name = "floor"
type = "plane"
[[contact]]
between = ["block", "floor"]
method = "analytic"
stiffness_pa_m = 1e7
[integrator]
rtol = 1e-4
[compare]
refresh_periods_s = [0.01, 0.001]
reference_rtol = 1e-4
reference_check = "cvode-bdf"
reference_check_rtol = 1e-4
[[compare.ladder]]
integrator = "cvode-bdf"
rtol = [1e-2]
[[compare.ladder]]
integrator = "linearly-implicit-euler"
step_s = [1e-3]
)";
  const compare::SceneComparison c = compare::run({loop::parse(text, "falling.toml")}, quick()).scenes[0];
  ASSERT_EQ(c.restarts.size(), 4u);
  const auto& rare = c.restarts[0];
  const auto& often = c.restarts[1];
  ASSERT_EQ(rare.integrator, "cvode-bdf");
  EXPECT_TRUE(rare.multistep);
  EXPECT_DOUBLE_EQ(often.setting, 0.001);
  EXPECT_GT(often.result.counters.reinits, rare.result.counters.reinits);
  EXPECT_GT(often.result.counters.steps, rare.result.counters.steps);
  EXPECT_FALSE(c.restarts[2].multistep);
  EXPECT_EQ(c.restarts[2].result.counters.steps, 40);
  EXPECT_EQ(c.restarts[3].result.counters.steps, 40);
}
#endif

TEST(BenchFem, StagesAddUpToTheStep) {
  const bench::FemBench b = bench::bench_fem(8, 0.01, 4, "cholmod");
  EXPECT_EQ(b.nodes, 9 * 3 * 3);
  EXPECT_EQ(b.tetrahedra, 5 * 8 * 2 * 2);
  EXPECT_GT(b.force_ms, 0.0);
  EXPECT_GT(b.tangent_ms, 0.0);
  EXPECT_GT(b.factor_ms, 0.0);
  EXPECT_GT(b.solve_ms, 0.0);
  EXPECT_NEAR(b.force_ms + b.tangent_ms + b.factor_ms + b.solve_ms + b.other_ms, b.step_ms, 1e-12);
  EXPECT_THROW(bench::bench_fem(2, 0.01, 4, "cholmod"), Error);
}

TEST(BenchLeaveOut, RefusesASceneThatLeavesNothingOut) {
  EXPECT_THROW(bench::bench_leave_out(small_scenes::pressed_block(0.001), 1), Error);
}

}  // namespace
