// A process killed while it writes leaves every reported step readable, with the right numbers.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <cstdio>
#include <random>

#include "store/sample_run.h"

namespace {

/// Starts the endless writer and kills it `more_us` after it has reported `steps` steps; returns the
/// number of steps reported by then.
int kill_after(const std::string& path, int expected, int steps, int more_us) {
  int ends[2];
  if (pipe(ends) != 0) return -1;
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
    close(ends[1]);
    execl(PALPATE_TEST_ENDLESS_RUN, PALPATE_TEST_ENDLESS_RUN, path.c_str(), std::to_string(expected).c_str(),
          static_cast<char*>(nullptr));
    _exit(127);
  }
  close(ends[1]);
  std::FILE* from = fdopen(ends[0], "r");
  int reported = 0;
  while (reported < steps && std::fscanf(from, "%d", &reported) == 1) {}
  usleep(static_cast<useconds_t>(more_us));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  while (std::fscanf(from, "%d", &reported) == 1) {}  // lines that were already in the pipe
  std::fclose(from);
  return reported;
}

TEST(RunKill, LeavesEveryCommittedStep) {
  std::mt19937 random(7);
  const sample_run::Folder folder;
  for (int i = 0; i < 30; ++i) {
    const std::string path = folder / "run.vtkhdf";
    // room for all steps within the time: the file is changed by steps only
    const int expected = 5000;
    const int reported =
        kill_after(path, expected, 1 + static_cast<int>(random() % 20), static_cast<int>(random() % 3000));
    ASSERT_GE(reported, 1);
    const palpate::store::RunReader run(path);
    ASSERT_GE(run.steps(), reported);
    ASSERT_LE(run.steps(), reported + 1) << "at most the step that it could not report any more";
    for (int s = 0; s < run.steps(); ++s) {
      ASSERT_EQ(run.points(s), sample_run::points(s)) << "step " << s << " of " << run.steps();
      ASSERT_EQ(run.stress(s), sample_run::stress(s));
      ASSERT_EQ(run.times_s()[static_cast<std::size_t>(s)], sample_run::time(s));
    }
  }
}

}  // namespace
