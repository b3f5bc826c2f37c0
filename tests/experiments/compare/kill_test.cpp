// A study that is repeatedly killed and restarted ends with the same table as an uninterrupted one.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <filesystem>
#include <random>

#include "experiments/compare/scenes.h"
#include "palpate/core/error.h"
#include "palpate/experiments/compare.h"
#include "store/result_db.h"
#include "temporary_folder.h"

using namespace palpate;
namespace fs = std::filesystem;

namespace {

compare::CompareOptions options_of(const fs::path& folder) {
  compare::CompareOptions options;
  options.repeats = 2;
  options.jobs = 2;
  options.integrators = {"linearly-implicit-euler", "cvode-bdf"};
  options.folder = folder.string();
  return options;
}

std::vector<scene::Description> scenes() {
  const std::string ladders = R"([[compare.ladder]]
integrator = "linearly-implicit-euler"
step_s = [2e-4, 1e-4, 5e-5, 2.5e-5]
[[compare.ladder]]
integrator = "cvode-bdf"
rtol = [1e-2, 1e-4, 1e-6, 1e-8]
)";
  return {compare_scenes::block(ladders, "one"), compare_scenes::block(ladders, "two", 3e4)};
}

long rows_in(const fs::path& folder) {
  if (!fs::exists(folder / "results.db")) return 0;
  try {
    return store::ResultDb((folder / "results.db").string(), store::ResultDb::Access::kRead).count();
  } catch (const Error&) { return 0; }  // the database is being created
}

/// Runs the study in a process and kills it `more_us` after the database holds `rows` results; returns true
/// if it was still running.
bool study_killed_after(const fs::path& folder, long rows, int more_us) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      compare::run(scenes(), options_of(folder));
    } catch (...) { _exit(1); }
    _exit(0);
  }
  int status = 0;
  while (rows_in(folder) < rows && waitpid(child, &status, WNOHANG) == 0) usleep(2000);
  usleep(static_cast<useconds_t>(more_us));
  kill(child, SIGKILL);
  return waitpid(child, &status, 0) == child && WIFSIGNALED(status);
}

TEST(CompareKill, TenKillsGiveTheTableOfAnUndisturbedRun) {
  const TemporaryFolder folder;
  const compare::Comparison whole = compare::run(scenes(), options_of(folder / "whole"));

  std::mt19937 random(11);
  int kills = 0, grew = 0;
  long kept = 0;
  for (int i = 0; i < 10; ++i) {
    const long rows = kept + static_cast<long>(random() % 3);
    kills += study_killed_after(folder / "killed", rows, static_cast<int>(random() % 10000));
    const long now = rows_in(folder / "killed");
    EXPECT_GE(now, kept) << "kill " << i;
    grew += now > kept;
    kept = now;
  }
  EXPECT_GE(kills, 8) << "they met it at work";
  EXPECT_GE(grew, 2) << "the kills hit different moments";
  const compare::Comparison last = compare::run(scenes(), options_of(folder / "killed"));
  EXPECT_GE(last.reused, kept) << "what was finished is not run again";

  ASSERT_EQ(last.scenes.size(), whole.scenes.size());
  for (std::size_t s = 0; s < whole.scenes.size(); ++s) {
    const compare::SceneComparison& a = whole.scenes[s];
    const compare::SceneComparison& b = last.scenes[s];
    EXPECT_EQ(a.reference.own_error.position_rel_l2, b.reference.own_error.position_rel_l2);
    EXPECT_EQ(a.reference.description, b.reference.description);
    ASSERT_EQ(a.points.size(), b.points.size());
    for (std::size_t p = 0; p < a.points.size(); ++p) {
      const compare::ComparePoint& x = a.points[p];
      const compare::ComparePoint& y = b.points[p];
      EXPECT_EQ(x.label, y.label);
      EXPECT_EQ(x.setting, y.setting);
      EXPECT_EQ(x.status, y.status);
      EXPECT_EQ(x.error.position_rel_l2, y.error.position_rel_l2);  // bitwise
      EXPECT_EQ(x.error.energy_j, y.error.energy_j);
      EXPECT_EQ(x.result.counters.steps, y.result.counters.steps);
      EXPECT_EQ(x.result.counters.force_evaluations, y.result.counters.force_evaluations);
      EXPECT_EQ(x.result.counters.solver.factorisations, y.result.counters.solver.factorisations);
      EXPECT_EQ(x.unresolved, y.unresolved);
    }
  }
}

}  // namespace
