#include "experiments/study/plan.h"

#include <gtest/gtest.h>

#include <set>

#include "experiments/study/block.h"
#include "messages.h"
#include "palpate/core/error.h"

using namespace palpate;
using namespace palpate::study_scenes;
using study::Plan;
using study::Task;

namespace {

/// The specific values of each task in one word: "cvode-bdf 1e-3 2e4".
std::vector<std::string> words_of(const Plan& plan) {
  std::vector<std::string> out;
  for (const Task& task : plan.tasks) {
    std::string& word = out.emplace_back(task.integrator + " " + task.rtol + task.step_s);
    for (const auto& [name, value] : task.varied) word += " " + value;
  }
  return out;
}

std::set<std::string> keys_of(const Plan& plan) {
  std::set<std::string> out;
  for (const Task& task : plan.tasks) out.insert(task.key);
  return out;
}

}  // namespace

TEST(StudyPlan, IsTheProductInTheOrderOfTheFile) {
  const TemporaryFolder folder;
  Plan plan = plan_of(folder, R"(integrators = ["cvode-bdf", "backward-euler"]
rtol = [1e-3, 1e-4]
step_s = [0.01, 0.005, 0.002]
[[sweep]]
key = "body.0.youngs_modulus_pa"
values = [1e4, 2e4]
)");
  study::settle_all(plan, {});
  EXPECT_EQ(words_of(plan),
            (std::vector<std::string>{"cvode-bdf 0.001 10000.0", "cvode-bdf 0.001 20000.0",
                                      "cvode-bdf 0.0001 10000.0", "cvode-bdf 0.0001 20000.0",
                                      "backward-euler 0.01 10000.0", "backward-euler 0.01 20000.0",
                                      "backward-euler 0.005 10000.0", "backward-euler 0.005 20000.0",
                                      "backward-euler 0.002 10000.0", "backward-euler 0.002 20000.0"}));
  for (std::size_t i = 0; i < plan.tasks.size(); ++i) EXPECT_EQ(plan.tasks[i].index, i);
  EXPECT_EQ(keys_of(plan).size(), plan.tasks.size());
}

TEST(StudyPlan, SweepsMoveTogetherWhereTheySaySo) {
  const TemporaryFolder folder;
  const std::string two = R"([[sweep]]
key = "body.0.youngs_modulus_pa"
values = [1e4, 2e4]
[[sweep]]
key = "body.0.poissons_ratio"
values = [0.3, 0.4]
)";
  Plan product = plan_of(folder, two), zipped = plan_of(folder, two + "together = true\n");
  study::settle_all(product, {});
  study::settle_all(zipped, {});
  const std::string own = "linearly-implicit-euler 0.001 ";
  EXPECT_EQ(words_of(product), (std::vector<std::string>{own + "10000.0 0.3", own + "10000.0 0.4",
                                                         own + "20000.0 0.3", own + "20000.0 0.4"}));
  EXPECT_EQ(words_of(zipped), (std::vector<std::string>{own + "10000.0 0.3", own + "20000.0 0.4"}));
}

TEST(StudyPlan, SeedsDrawTheSameForEveryIntegrator) {
  const TemporaryFolder folder;
  Plan plan = plan_of(folder, R"(seeds = [4, 9]
integrators = ["cvode-bdf", "backward-euler"]
[[random]]
key = "body.0.youngs_modulus_pa"
min = 1e4
max = 2e4
)");
  ASSERT_EQ(plan.tasks.size(), 4u);
  for (const Task& task : plan.tasks) {
    ASSERT_EQ(task.varied.size(), 2u);
    EXPECT_EQ(task.varied[0].first, "seed");
    const std::string& value = task.varied[1].second;
    EXPECT_EQ(task.overrides.back(), "body.0.youngs_modulus_pa=" + value);
    EXPECT_EQ(value, scene::drawn_value(plan.spec.randoms[0], std::stoi(task.varied[0].second)));
  }
  EXPECT_EQ(plan.tasks[0].varied, plan.tasks[2].varied);
  EXPECT_EQ(plan.tasks[1].varied, plan.tasks[3].varied);
  EXPECT_NE(plan.tasks[0].varied, plan.tasks[1].varied);
}

TEST(StudyPlan, KeysFollowTheSceneAndNotTheTable) {
  const TemporaryFolder folder;
  const std::string sweep = "[[sweep]]\nkey = \"body.0.youngs_modulus_pa\"\nvalues = ";
  Plan two = plan_of(folder, sweep + "[1e4, 2e4]\n"), three = plan_of(folder, sweep + "[3e4, 1e4, 2e4]\n");
  Plan longer = plan_of(folder, "limit_s = 9\n" + sweep + "[1e4, 2e4]\n");
  Plan twice = plan_of(folder, "repeats = 2\n" + sweep + "[1e4, 2e4]\n");
  for (Plan* plan : {&two, &three, &longer, &twice}) study::settle_all(*plan, {});
  EXPECT_EQ(two.tasks[0].key, three.tasks[1].key) << "a study that grows keeps what it has";
  EXPECT_EQ(two.tasks[0].key, longer.tasks[0].key) << "a limit changes no figure";
  EXPECT_NE(two.tasks[0].key, twice.tasks[0].key);
  EXPECT_NE(two.key, three.key);
  folder.write("block.toml", kBlock + "max_steps = 1000\n");
  Plan changed = study::list_tasks(two.spec, {});
  study::settle_all(changed, {});
  EXPECT_NE(two.tasks[0].key, changed.tasks[0].key) << "another scene has other results";
  EXPECT_NE(two.key, changed.key);
}

TEST(StudyPlan, WhatOneTaskOfSeveralCannotDoIsItsResult) {
  const TemporaryFolder folder;
  Plan plan = plan_of(folder, "[[sweep]]\nkey = \"body.0.poissons_ratio\"\nvalues = [0.3, 0.6]\n");
  study::settle_all(plan, {});
  EXPECT_EQ(plan.tasks[0].refused, "");
  expectations::expect_contains(plan.tasks[1].refused, "poissons_ratio = 0.6");
  EXPECT_EQ(plan.tasks[1].key, "");
}

TEST(StudyPlan, RefusesWhatNoTaskCanDo) {
  const TemporaryFolder folder;
  const auto said = [&](const std::string& study) {
    return expectations::message_of([&] {
      Plan plan = plan_of(folder, study);
      study::settle_all(plan, {});
    });
  };
  const std::string typo = said("[[sweep]]\nkey = \"body.0.youngs_modulus\"\nvalues = [1e4]\n");
  expectations::expect_contains(typo, "every task of scene block.toml is rejected");
  expectations::expect_contains(typo, "did you mean \"youngs_modulus_pa\"?");
  expectations::expect_contains(said("integrators = [\"cvode-bfd\"]\n"), "did you mean \"cvode-bdf\"?");
  expectations::expect_contains(said("set = [\"body.1.name=x\"]\n"), "every task of scene");
  expectations::expect_contains(
      said("seeds = 1000\n[[random]]\nkey = \"body.0.youngs_modulus_pa\"\nmin = 1\nmax = 2\n[[sweep]]\nkey = "
           "\"body.0.poissons_ratio\"\nfrom = 0.1\nto = 0.4\ncount = 1001\n"),
      "more than 1000000 tasks");
}

TEST(StudyPlan, NamesASceneThatIsNotThere) {
  const TemporaryFolder folder;
  const auto plan = [&](const std::string& scene) {
    const auto path = folder.write("my.toml", "[study]\nscenes = [\"" + scene + "\"]\n");
    study::list_tasks(scene::load_study(path.string()), {[](const std::string& name) -> std::string {
                        fail("{}: no scene has this name", name);
                      }});
  };
  expectations::expect_contains(expectations::message_of([&] { plan("gone.toml"); }), "gone.toml: no such");
  expectations::expect_contains(expectations::message_of([&] { plan("press-bal"); }), "press-bal: no scene");
}
