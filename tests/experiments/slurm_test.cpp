// Texts passed to Slurm; cli.slurm runs a cluster.
#include "experiments/slurm.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "experiments/indices.h"
#include "messages.h"
#include "temporary_folder.h"

using namespace palpate;
using experiments::elements_of;

namespace {

/// Replaces Slurm's programs by those of a folder during the lifetime of this object.
class FakeSlurm {
 public:
  explicit FakeSlurm(const TemporaryFolder& folder) : folder_(folder), path_(getenv("PATH")) {
    setenv("PATH", (folder.string() + ":" + path_).c_str(), 1);
  }
  ~FakeSlurm() { setenv("PATH", path_.c_str(), 1); }
  void answers(const std::string& name, const std::string& script) const {
    chmod(folder_.write(name, "#!/bin/sh\n" + script).c_str(), 0755);
  }

 private:
  const TemporaryFolder& folder_;
  std::string path_;
};

}  // namespace

TEST(Slurm, GroupsAreSharedOutOverTheElements) {
  EXPECT_EQ(elements_of({{0}, {1}, {2}}, 1, 1001), (std::vector<std::string>{"0", "1", "2"}));
  EXPECT_EQ(elements_of({{0}, {1}, {2}, {7}}, 3, 1001), (std::vector<std::string>{"0-2", "7"}));
  EXPECT_EQ(elements_of({{0}, {2}, {3}, {5}, {6}}, 1, 2), (std::vector<std::string>{"0,2-3", "5-6"}))
      << "more tasks than the site has elements";
  EXPECT_EQ(elements_of({{4}}, 5, 1), (std::vector<std::string>{"4"}));
  EXPECT_EQ(elements_of({{0, 3, 6}, {1, 4}, {2}}, 1, 1001), (std::vector<std::string>{"0,3,6", "1,4", "2"}))
      << "a group is never torn apart";
  EXPECT_EQ(elements_of({{0, 3}, {1, 2}}, 2, 1001), (std::vector<std::string>{"0-3"}));
}

TEST(Indices, AreReadAndWritten) {
  using experiments::indices_of;
  EXPECT_EQ(indices_of("0-3,7", 8), (std::vector<std::size_t>{0, 1, 2, 3, 7}));
  EXPECT_EQ(indices_of("7,2,2-3", 8), (std::vector<std::size_t>{2, 3, 7}));
  EXPECT_EQ(experiments::text_of({0, 1, 2, 3, 7}), "0-3,7");
  EXPECT_EQ(experiments::text_of({5}), "5");
  for (const char* bad : {"", "x", "1-", "-1", "1,,2", "3-1", "1 2"})
    EXPECT_NE(expectations::message_of([&] { indices_of(bad, 8); }), "") << bad;
  expectations::expect_contains(expectations::message_of([] { indices_of("8", 8); }),
                                "tasks 0 to 7, and no 8");
}

TEST(Slurm, TheScriptNamesWhatAnElementRuns) {
  experiments::ArrayJob job{"/opt/it's here/palpate",
                            "study",
                            {"/shared/my study.toml"},
                            "soft & % hard",
                            "/shared/my\nstudy.toml",
                            std::string(32, 'f'),
                            "/shared/out 100%",
                            "--time=10\n--oops",
                            3,
                            {"0-1", "5"}};
  const std::string script = experiments::sbatch_script(job);
  for (const char* line :
       {"#!/bin/bash\n", "#SBATCH --job-name=palpate-soft-----hard\n", "#SBATCH --array=0-1\n",
        "#SBATCH --cpus-per-task=3\n", "#SBATCH --output=\"/shared/out 100%%/slurm/%A_%a.log\"\n",
        "#SBATCH --time=10 --oops\n", "tasks=(\n  0-1\n  5\n)\n", "tasks[k] of /shared/my study.toml.\n",
        "exec '/opt/it'\\''s here/palpate' study '/shared/my study.toml' -o '/shared/out 100%' --jobs 1 "
        "--plan "})
    expectations::expect_contains(script, line);
  expectations::expect_contains(script, job.key + " --task \"${tasks[$SLURM_ARRAY_TASK_ID]}\"\n");
  job.options.clear();
  EXPECT_EQ(experiments::sbatch_script(job).find("oops"), std::string::npos);
}

TEST(Slurm, SaysAllThatSbatchSaid) {
  const TemporaryFolder folder;
  const FakeSlurm slurm(folder);
  slurm.answers("sbatch", "echo 'sbatch: error: invalid partition' >&2; echo 'no such thing' >&2; exit 1");
  const std::string said = expectations::message_of([] { experiments::submit("x.sbatch"); });
  expectations::expect_contains(said, "exit status 1");
  expectations::expect_contains(said, "sbatch: error: invalid partition\nno such thing");
  slurm.answers("sbatch", "echo \"42;cluster $*\"");
  EXPECT_EQ(experiments::submit("x.sbatch"), "42");
}

TEST(Slurm, ReadsWhatSlurmAnswers) {
  const TemporaryFolder folder;
  const FakeSlurm slurm(folder);
  slurm.answers("scontrol", "echo 'Foo = 3'; echo 'MaxArraySize            = 25'");
  EXPECT_EQ(experiments::max_array_size(), 25u);
  slurm.answers("scontrol", "echo 'Unable to contact slurm controller' >&2; exit 1");
  EXPECT_EQ(experiments::max_array_size(), 1001u);
  slurm.answers("squeue", "echo PENDING");
  EXPECT_EQ(experiments::job_state("7"), experiments::JobState::kWaiting);
  slurm.answers("squeue", "exit 0");
  EXPECT_EQ(experiments::job_state("7"), experiments::JobState::kOver);
  slurm.answers("squeue", "echo 'slurm_load_jobs error: Invalid job id specified' >&2; exit 1");
  EXPECT_EQ(experiments::job_state("7"), experiments::JobState::kOver);
  slurm.answers("squeue", "echo 'slurm_load_jobs error: Unable to contact slurm controller' >&2; exit 1");
  EXPECT_EQ(experiments::job_state("7"), experiments::JobState::kUnknown);
}

TEST(Slurm, NamesThePackageWhereThereIsNoSlurm) {
  const std::string said = expectations::message_of([] { experiments::ask({"no-such-sbatch", "x"}); });
  expectations::expect_contains(said, "no-such-sbatch was not found");
  expectations::expect_contains(said, "slurm-client");
}
