#include "experiments/engine.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <functional>
#include <new>
#include <set>

#include "core/archive_bytes.h"
#include "messages.h"
#include "palpate/core/error.h"

using namespace palpate;
using namespace palpate::experiments;
using Indices = std::vector<std::size_t>;

namespace {

/// Does what the input says, in the process of the task.
std::string work(const std::string& input, const std::atomic<bool>& out_of_time) {
  Result out;
  if (input == "crash") raise(SIGSEGV);
  if (input == "killed") raise(SIGKILL);
  if (input == "throws") throw std::runtime_error("a defect");
  if (input == "no memory") throw std::bad_alloc();
  while (input == "endless" && !out_of_time) {}
  if (input == "endless") out.status = Status::kOutOfTime;
  if (input == "refused") out.status = Status::kRefused, out.reason = "because";
  if (input == "slow") usleep(200000);
  out.cpu_s = 0.5;
  out.bytes = "did " + input;
  return archived(out);
}

/// List of inputs as an experiment; the functions of a test replace the defaults.
class Inputs : public Experiment {
 public:
  explicit Inputs(std::vector<std::string> inputs) : inputs_(std::move(inputs)) {}
  std::size_t size() const override { return inputs_.size(); }
  Task task(std::size_t i) override {
    return {"test", keyed ? "key of " + inputs_[i] + std::to_string(i) : "", inputs_[i], work, limit_s,
            alone};
  }
  std::string input(std::size_t i) override {
    started.push_back(i);
    if (!taken.contains(i)) running = std::max(running, started.size() - taken.size());
    return inputs_[i];
  }
  void take(std::size_t i, const Result& result) override {
    EXPECT_TRUE(taken.emplace(i, result).second) << "task " << i << " was taken twice";
  }
  bool is_ready(std::size_t i) override { return !ready || ready(i); }
  bool is_wanted(std::size_t i) override { return !wanted || wanted(i); }
  bool is_final(std::size_t, const Result& result) override { return !final || final(result); }
  bool has_dependencies() const override { return static_cast<bool>(ready); }
  std::size_t group(std::size_t i) override { return grouped ? grouped(i) : i; }
  std::string key() override { return "the list"; }

  bool keyed = true, alone = false;
  double limit_s = 60.0;
  std::function<bool(std::size_t)> ready, wanted;
  std::function<bool(const Result&)> final;
  std::function<std::size_t(std::size_t)> grouped;
  std::map<std::size_t, Result> taken;
  Indices started;
  std::size_t running = 0;  ///< Largest number of tasks at the same time.

 private:
  std::vector<std::string> inputs_;
};

EngineOptions with_jobs(int jobs) {
  EngineOptions out;
  out.jobs = jobs;
  return out;
}

}  // namespace

TEST(Engine, EveryEndOfATaskHasItsStatus) {
  Inputs inputs({"fine", "refused", "crash", "throws", "killed", "no memory"});
  ResultStore store;
  const EngineOutcome outcome = run(inputs, store, with_jobs(2));
  ASSERT_EQ(inputs.taken.size(), 6u);
  EXPECT_EQ(inputs.taken[0].status, Status::kOk);
  EXPECT_EQ(inputs.taken[0].bytes, "did fine");
  EXPECT_EQ(inputs.taken[0].cpu_s, 0.5);
  EXPECT_EQ(inputs.taken[0].limit_s, 60.0);
  EXPECT_NE(inputs.taken[0].machine.host, "");
  EXPECT_EQ(inputs.taken[1].status, Status::kRefused);
  EXPECT_EQ(inputs.taken[1].reason, "because");
  EXPECT_EQ(inputs.taken[2].status, Status::kCrashed);
  expectations::expect_contains(inputs.taken[2].reason, "killed by signal 11");
  EXPECT_EQ(inputs.taken[3].status, Status::kCrashed);
  EXPECT_EQ(inputs.taken[3].reason, "internal error: a defect");
  EXPECT_EQ(inputs.taken[4].status, Status::kMissing);
  EXPECT_EQ(inputs.taken[5].reason, "not enough memory");
  EXPECT_EQ(outcome.run, 4u);
  ASSERT_EQ(outcome.lost.size(), 2u);
  EXPECT_FALSE(outcome.complete);

  Inputs again({"fine", "refused", "crash", "throws", "killed", "no memory"});
  EXPECT_EQ(run(again, store, with_jobs(2)).reused, 4u) << "what was lost is not stored";
  EXPECT_EQ(std::set(again.started.begin(), again.started.end()), (std::set<std::size_t>{4, 5}));
  EXPECT_EQ(again.taken[0].bytes, "did fine");
}

TEST(Engine, MoreTimeIsAnotherAttempt) {
  ResultStore store;
  for (const auto& [limit_s, runs] : {std::pair{0.1, 1u}, {0.1, 0u}, {0.2, 1u}, {0.1, 0u}}) {
    Inputs inputs({"endless"});
    inputs.limit_s = limit_s;
    EXPECT_EQ(run(inputs, store, with_jobs(1)).run, runs) << limit_s;
    EXPECT_EQ(inputs.taken[0].status, Status::kOutOfTime);
  }
}

TEST(Engine, WaitsForWhatATaskNeeds) {
  Inputs inputs({"last", "dropped", "first", "middle"});
  inputs.ready = [&](std::size_t i) {
    return i == 2 || (i == 3 && inputs.taken.contains(2)) || (i == 0 && inputs.taken.contains(3));
  };
  inputs.wanted = [&](std::size_t i) { return i != 1 || !inputs.taken.contains(2); };
  ResultStore store;
  const EngineOutcome outcome = run(inputs, store, with_jobs(3));
  EXPECT_EQ(inputs.started, (Indices{2, 3, 0}));
  EXPECT_TRUE(outcome.complete);
}

TEST(Engine, RunsSoManyAtATime) {
  const std::vector<std::string> slow(6, "slow");
  for (const int jobs : {1, 3}) {
    Inputs inputs(slow);
    ResultStore store;
    run(inputs, store, with_jobs(jobs));
    EXPECT_EQ(inputs.running, static_cast<std::size_t>(jobs));
  }
  Inputs inputs(slow);
  inputs.alone = true;
  ResultStore store;
  run(inputs, store, with_jobs(3));
  EXPECT_EQ(inputs.running, 1u) << "timed tasks run alone";
}

TEST(Engine, StoresOnlyWhatIsFinalAndHasAKey) {
  ResultStore store;
  for (const bool keyed : {true, false})
    for (int i = 0; i < 2; ++i) {
      Inputs inputs({"fine", "refused"});
      inputs.keyed = keyed;
      inputs.final = [](const Result& result) { return result.status == Status::kOk; };
      EXPECT_EQ(run(inputs, store, with_jobs(1)).reused, keyed && i == 1 ? 1u : 0u);
    }
}

TEST(Engine, StopsWithoutTheActiveTask) {
  std::atomic<bool> stop{false};
  Inputs inputs({"fine", "slow", "slow"});
  EngineOptions options = with_jobs(1);
  options.stop = &stop;
  options.progress = [&](double fraction, const std::string& what) {
    EXPECT_NEAR(fraction, 1.0 / 3.0, 1e-12);
    EXPECT_EQ(what, "fine");
    stop = true;
  };
  ResultStore store;
  const EngineOutcome outcome = run(inputs, store, options);
  EXPECT_TRUE(outcome.stopped);
  EXPECT_EQ(inputs.taken.size(), 1u);
}

TEST(Engine, AnElementRunsItsTasksOnly) {
  ResultStore store;
  std::vector<LostTask> lost;
  const auto chain = [](Inputs& inputs) {
    inputs.ready = [&inputs](std::size_t i) { return i == 0 || inputs.taken.contains(i - 1); };
  };
  const auto run_list = [&](const std::string& list, const std::string& plan) {
    Inputs inputs({"a", "b", "c"});
    chain(inputs);
    const EngineOutcome outcome = run(inputs, Place{&store, {}, list, plan}, with_jobs(1));
    EXPECT_EQ(outcome.other_plan, plan == "another list");
    lost = outcome.lost;
    EXPECT_EQ(outcome.reused, 0u) << "results of other elements were not requested";
    return inputs.started;
  };
  EXPECT_EQ(run_list("1-2", "the list"), Indices{}) << "what they need is not there";
  ASSERT_EQ(lost.size(), 2u);
  EXPECT_EQ(lost[0].index, 1u);
  EXPECT_EQ(lost[0].why, "needs the result of another task");
  EXPECT_EQ(run_list("0", "another list"), Indices{});
  EXPECT_EQ(run_list("0", "the list"), Indices{0});
  EXPECT_EQ(run_list("1-2", ""), (Indices{1, 2}));
  EXPECT_TRUE(lost.empty());
}

TEST(Engine, ProgressCountsTheRequestedTasks) {
  Inputs inputs({"a", "dropped", "b", "not requested"});
  inputs.ready = [](std::size_t) { return true; };
  inputs.wanted = [](std::size_t i) { return i != 1; };
  const Indices only = {0, 1, 2};
  EngineOptions options = with_jobs(1);
  options.only = &only;
  std::vector<double> fractions;
  options.progress = [&](double fraction, const std::string&) { fractions.push_back(fraction); };
  ResultStore store;
  run(inputs, store, options);
  ASSERT_EQ(fractions.size(), 2u);
  EXPECT_NEAR(fractions[1], 1.0, 1e-12);
}

TEST(Engine, SubmitsGroupsWhenTheyAreReady) {
  ResultStore store;
  std::vector<std::vector<Indices>> jobs;
  Inputs inputs({"reference", "b1", "a1", "b2", "a2", "lost", "after lost"});
  inputs.ready = [&](std::size_t i) {
    if (i == 0 || i == 5) return true;
    return i == 6 ? inputs.taken.contains(5) : inputs.taken.contains(0);
  };
  inputs.grouped = [](std::size_t i) { return i == 3 ? 1 : i == 4 ? 2 : i; };
  EngineOptions options;
  options.submit = [&](Experiment& experiment, const std::vector<Indices>& groups) {
    jobs.push_back(groups);
    for (const Indices& group : groups)
      for (const std::size_t i : group) {
        if (i == 5) continue;  // as if its node failed
        Result result;
        result.bytes = "from a node";
        store.put(experiment.task(i), result);
      }
    return true;
  };
  const EngineOutcome outcome = run(inputs, store, options);
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[0], (std::vector<Indices>{{0}, {5}}));
  EXPECT_EQ(jobs[1], (std::vector<Indices>{{1, 3}, {2, 4}})) << "no second attempt for what was lost";
  EXPECT_EQ(inputs.taken.size(), 5u);
  EXPECT_EQ(inputs.taken[4].bytes, "from a node");
  EXPECT_EQ(inputs.started, Indices{});
  EXPECT_FALSE(outcome.complete);
  ASSERT_EQ(outcome.lost.size(), 1u);
  EXPECT_EQ(outcome.lost[0].index, 5u);
}

TEST(Engine, KeysDependOnTheWordsAndWhereTheyEnd) {
  EXPECT_EQ(key_of({"a", "b"}), key_of({"a", "b"}));
  EXPECT_NE(key_of({"a", "b"}), key_of({"ab"}));
}
