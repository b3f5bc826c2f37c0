#include "experiments/study/run.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <numeric>

#include "experiments/indices.h"
#include "experiments/study/block.h"
#include "experiments/study/results.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/csv.h"

using namespace palpate;
using namespace palpate::study_scenes;
namespace fs = std::filesystem;
using experiments::ResultStore;
using study::Plan;
using study::RunOutcome;

namespace {

const std::string kStudy = R"(integrators = ["cvode-bdf", "linearly-implicit-euler"]
rtol = [1e-2, 1e-3]
step_s = [2e-3]
[[sweep]]
key = "body.0.youngs_modulus_pa"
values = [1e4, 2e4]
)";

std::vector<std::size_t> all_of(const Plan& plan) {
  std::vector<std::size_t> out(plan.tasks.size());
  std::iota(out.begin(), out.end(), std::size_t{0});
  return out;
}

/// Runs tasks as a command does: all, or those of `--task LIST`.
RunOutcome run(Plan& plan, const fs::path& folder, int jobs = 2, const std::string& list = "") {
  experiments::EngineOptions options;
  options.jobs = jobs;
  ResultStore store =
      list.empty() ? ResultStore::here(folder.string(), false) : ResultStore::element(folder.string(), list);
  const auto indices = list.empty() ? all_of(plan) : experiments::indices_of(list, plan.tasks.size());
  const RunOutcome outcome = study::run_tasks(plan, indices, {}, store, options);
  store.close();
  return outcome;
}

study::Results merge(const Plan& plan, const fs::path& folder) {
  return study::merge(plan, ResultStore::read(folder.string()));
}

/// study.csv of the folder's results, byte for byte.
std::string table_of(Plan& plan, const fs::path& folder) {
  study::settle_all(plan, {});
  study::write(plan, merge(plan, folder), folder.string());
  return store::read_file((folder / "study.csv").string());
}

}  // namespace

TEST(StudyRun, GivesTheSameTableWhicheverWayItRan) {
  const TemporaryFolder folder;
  Plan plan = plan_of(folder, kStudy);
  const RunOutcome outcome = run(plan, folder / "two");
  EXPECT_EQ(outcome.run, plan.tasks.size());
  EXPECT_TRUE(outcome.lost.empty());
  const std::string two = table_of(plan, folder / "two");

  Plan alone = plan_of(folder, kStudy);
  run(alone, folder / "one", 1);
  EXPECT_EQ(table_of(alone, folder / "one"), two);

  for (std::size_t i = plan.tasks.size(); i-- > 0;) {  // each with a separate plan, the last one first
    Plan single = plan_of(folder, kStudy);
    EXPECT_EQ(run(single, folder / "each", 1, std::to_string(i)).run, 1u);
    EXPECT_FALSE(single.tasks[(i + 1) % plan.tasks.size()].settled) << "a list of a million costs nothing";
  }
  Plan merged = plan_of(folder, kStudy);
  EXPECT_EQ(table_of(merged, folder / "each"), two);

  const store::CsvTable table = store::read_csv((folder / "two" / "study.csv").string());
  EXPECT_EQ(table.column("status"), std::vector<std::string>(6, "ok"));
  EXPECT_EQ(table.column("integrator")[0], "cvode-bdf");
  EXPECT_EQ(table.column("rtol"), (std::vector<std::string>{"0.01", "0.01", "0.001", "0.001", "", ""}));
  EXPECT_EQ(table.column("step_s")[5], "0.002");
  EXPECT_EQ(table.numbers("body.0.youngs_modulus_pa")[1], 2e4);
  const std::vector<double> steps = table.numbers("steps"), moved = table.numbers("largest_displacement_m");
  EXPECT_EQ(steps[4], 10.0);            // 0.02 s in steps of 2 ms
  EXPECT_GT(moved[0], 1.5 * moved[1]);  // twice as stiff
  EXPECT_NE(table.column("end_state")[0], table.column("end_state")[1]);
}

TEST(StudyRun, DoesOnlyWhatIsMissing) {
  const TemporaryFolder folder;
  Plan plan = plan_of(folder, kStudy);
  run(plan, folder.path());
  const std::string whole = table_of(plan, folder.path());
  EXPECT_EQ(run(plan, folder.path()).reused, plan.tasks.size());

  EXPECT_EQ(run(plan, folder / "parts", 1, "0-1").run, 2u);
  EXPECT_EQ(run(plan, folder / "parts", 1, "3").run, 1u);
  const study::Results partial = merge(plan, folder / "parts");
  EXPECT_EQ(partial.missing, (std::vector<std::size_t>{2, 4, 5}));
  EXPECT_EQ(partial.count("missing"), 3u);
  EXPECT_EQ(partial.count("ok"), 3u);
  const RunOutcome again = run(plan, folder / "parts");
  EXPECT_EQ(again.run, 3u);
  EXPECT_EQ(again.reused, 3u);
  EXPECT_EQ(table_of(plan, folder / "parts"), whole);

  ResultStore::here(folder.string(), true);
  EXPECT_EQ(merge(plan, folder.path()).missing.size(), plan.tasks.size());
}

TEST(StudyRun, OldResultsAreNotMixedIn) {
  const TemporaryFolder folder;
  Plan plan = plan_of(folder, kStudy);
  run(plan, folder.path());
  folder.write("block.toml", kBlock + "max_steps = 1000\n");
  Plan changed = study::list_tasks(plan.spec, {});
  study::settle_all(changed, {});
  EXPECT_EQ(merge(changed, folder.path()).missing.size(), changed.tasks.size());
}

TEST(StudyRun, ATaskThatRunsOutOfTimeLeavesTheOthers) {
  const TemporaryFolder folder;
  const std::string sweep = "[[sweep]]\nkey = \"scene.gravity_m_s2\"\nvalues = [[0, 0, -1]]\n";
  const std::string steps =
      "limit_s = 0.3\nstep_s = [1e-3, 1e-9]\nset = [\"integrator.max_steps=2000000000\"]\n";
  Plan plan = plan_of(folder, steps + sweep);
  EXPECT_EQ(run(plan, folder.path()).run, 2u);
  study::Results results = merge(plan, folder.path());
  EXPECT_EQ(results.rows[0].status, "ok");
  EXPECT_EQ(results.rows[1].status, "out of time");
  EXPECT_EQ(results.rows[1].reason, "out of time: 0.3 s of CPU");
  for (const std::string& one : results.rows[1].figures)
    EXPECT_EQ(one, "") << "no figure of where it stopped";
  EXPECT_EQ(run(plan, folder.path()).reused, 2u);
  plan.spec.limit_s = 0.6;
  EXPECT_EQ(run(plan, folder.path()).run, 1u) << "with more time it is tried again";
  plan.spec.limit_s = 0.1;
  EXPECT_EQ(run(plan, folder.path()).reused, 2u);
  results = merge(plan, folder.path());
  EXPECT_EQ(results.rows[1].reason, "out of time: 0.1 s of CPU") << "whatever it had when it was run";
}

TEST(StudyRun, AMethodThatFailsSaysWhy) {
  const TemporaryFolder folder;
  Plan plan = plan_of(folder,
                      "integrators = [\"symplectic-euler\"]\nstep_s = [1e-5, 0.02]\n"
                      "duration_s = 2\n");
  run(plan, folder.path());
  const study::Results results = merge(plan, folder.path());
  EXPECT_NE(results.rows[1].status, "ok");
  EXPECT_NE(results.rows[1].reason, "");
}

TEST(StudyRun, RepeatsGiveMedians) {
  const TemporaryFolder folder;
  Plan once = plan_of(folder, ""), thrice = plan_of(folder, "repeats = 3\n");
  run(once, folder.path());
  run(thrice, folder.path());
  const study::Results a = merge(once, folder.path()), b = merge(thrice, folder.path());
  EXPECT_EQ(b.rows[0].status, "ok");
  EXPECT_EQ(a.rows[0].figures, b.rows[0].figures);
}

TEST(StudyRun, ASceneThatCannotBeAssembledIsRefused) {
  const TemporaryFolder folder;
  Plan plan = plan_of(folder,
                      "[[sweep]]\nkey = \"body.0.attachment.0.box_min_m\"\n"
                      "values = [[-1, -1, -1], [0.5, 0.5, -1]]\n");
  run(plan, folder.path());
  const study::Results results = merge(plan, folder.path());
  EXPECT_EQ(results.rows[0].status, "ok");
  EXPECT_EQ(results.rows[1].status, "refused");
  EXPECT_NE(results.rows[1].reason.find("attachment"), std::string::npos) << results.rows[1].reason;
}
