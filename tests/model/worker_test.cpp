#include "cli/model_program/worker.h"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "temporary_folder.h"

using namespace palpate;
using namespace palpate::cli;

namespace {

/// A child process that ends by a division by zero, unless the stage is skipped.
int dies_in(const char* stage, bool requested) {
  worker_stage(stage);
  worker_place("at (1, 2, 3) m");
  if (requested) std::raise(SIGFPE);
  return 7;
}

}  // namespace

TEST(Worker, GivesBackTheStatus) {
  const WorkerEnd end = run_worker([] { return 3; });
  EXPECT_EQ(end.status, 3);
  EXPECT_EQ(end.signal, "");
}

TEST(Worker, ASignalIsReportedWithStageAndPlace) {
  const WorkerEnd end = run_worker([] { return dies_in("cut", true); });
  EXPECT_EQ(end.signal, "Floating point exception");
  EXPECT_EQ(end.stage, "cut");
  EXPECT_EQ(end.place, "at (1, 2, 3) m");
}

TEST(Worker, NothingIsLeftInTheFolderOfTheCaller) {
  const TemporaryFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.string());
  const WorkerEnd end = run_worker([] {
    std::ofstream file("dump-bug.mesh");
    file << "text";
    return file.flush() ? 1 : 0;
  });
  const WorkerEnd core = run_worker([] { return dies_in("cut", true); });
  std::filesystem::current_path(before);
  EXPECT_EQ(end.status, 0) << "a file was made";
  EXPECT_NE(core.signal, "");
  EXPECT_TRUE(std::filesystem::is_empty(folder.string()));
}

TEST(Worker, AStageThatEndsTheProcessIsLeftOutOfTheNextAttempt) {
  for (const char* stage : {model::kMovingVertices, model::kExudingSlivers}) {
    const bool moving = stage == model::kMovingVertices;
    const WorkerEnd end = run_attempts({}, [&](const model::Optimisation& optimisation) {
      const bool requested = moving ? optimisation.move_vertices : optimisation.exude_slivers;
      const std::string& why = moving ? optimisation.why_not_moved : optimisation.why_not_exuded;
      return requested || why == "Floating point exception" ? dies_in(stage, requested) : 1;
    });
    EXPECT_EQ(end.signal, "");
    EXPECT_EQ(end.status, 7);
  }
}

TEST(Worker, OtherStagesAreNotTriedAgain) {
  const TemporaryFolder folder;
  const WorkerEnd end = run_attempts({}, [&](const model::Optimisation&) {
    std::ofstream(folder / "attempts", std::ios::app) << "x";
    return dies_in(model::kRefining, true);
  });
  EXPECT_EQ(end.stage, model::kRefining);
  EXPECT_EQ(std::filesystem::file_size(folder / "attempts"), 1u);
}
