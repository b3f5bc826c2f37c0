// Jobs in separate processes: effects of a crash, an endless loop, an exception and a dying parent.
#include "core/process_pool.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "core/bytes.h"
#include "core/clock.h"
#include "palpate/core/error.h"

using namespace palpate;
using palpate::ProcessPool;
using End = ProcessPool::Outcome::End;

namespace {

/// Starts the helper process before any test of this program starts a thread.
struct Prepared : testing::Environment {
  void SetUp() override { ProcessPool::prepare(); }
};
[[maybe_unused]] const auto* const kPrepared = testing::AddGlobalTestEnvironment(new Prepared);

ProcessPool::Outcome outcome_of(ProcessPool::Work work, const std::string& input = "",
                                double limit_s = 60.0) {
  ProcessPool pool(1);
  ProcessPool::Outcome out;
  int calls = 0;
  pool.start(work, input, limit_s, [&](const ProcessPool::Outcome& o) { out = o, ++calls; });
  EXPECT_FALSE(pool.has_room());
  while (!pool.idle()) pool.wait(1.0);
  EXPECT_EQ(calls, 1);
  return out;
}

void spin_until(const std::atomic<bool>* flag) {
  volatile double x = 0.0;
  while (!flag || !flag->load()) x = x + 1.0;
}

TEST(ProcessPool, TakesAndReturnsBytesWhole) {
  const std::string input = std::string(3'000'000, 'x') + std::string("\0end", 4);
  const auto outcome = outcome_of([](const auto& bytes, const auto&) { return bytes + "!"; }, input);
  EXPECT_EQ(outcome.end, End::kDone);
  EXPECT_EQ(outcome.bytes.size(), 3'000'005u);
  EXPECT_TRUE(outcome.bytes == input + "!");
}

TEST(ProcessPool, AnExceptionIsItsMessage) {
  const auto outcome =
      outcome_of([](const auto&, const auto&) -> std::string { throw Error("no such thing"); });
  EXPECT_EQ(outcome.end, End::kError);
  EXPECT_EQ(outcome.bytes, "no such thing");
}

TEST(ProcessPool, LackOfMemoryIsNoErrorOfTheWork) {
  const auto outcome = outcome_of([](const auto&, const auto&) -> std::string { throw std::bad_alloc(); });
  EXPECT_EQ(outcome.end, End::kNoMemory);
  EXPECT_EQ(outcome.bytes, "not enough memory");
}

TEST(ProcessPool, ACrashIsItsSignal) {
  const auto outcome = outcome_of([](const auto&, const auto&) -> std::string {
    raise(SIGSEGV);
    return "";
  });
  EXPECT_EQ(outcome.end, End::kCrash);
  EXPECT_NE(outcome.bytes.find("killed by signal 11"), std::string::npos) << outcome.bytes;
  EXPECT_EQ(outcome.signal, 11);
  const auto left = outcome_of([](const auto&, const auto&) -> std::string { _exit(3); });
  EXPECT_EQ(left.end, End::kCrash);
  EXPECT_NE(left.bytes.find("exit status 3"), std::string::npos) << left.bytes;
}

TEST(ProcessPool, WorkThatHeedsItsLimitEndsByItself) {
  const auto outcome = outcome_of(
      [](const auto&, const std::atomic<bool>& late) {
        spin_until(&late);
        return std::string("cut short");
      },
      "", 0.1);
  EXPECT_EQ(outcome.end, End::kDone);
  EXPECT_EQ(outcome.bytes, "cut short");
}

TEST(ProcessPool, WorkThatDoesNotIsKilled) {
  const auto outcome = outcome_of(
      [](const auto&, const auto&) {
        spin_until(nullptr);
        return std::string();
      },
      "", 0.1);
  EXPECT_EQ(outcome.end, End::kOutOfTime);
  EXPECT_EQ(outcome.bytes, "out of time: 0.1 s");
  // uses no CPU time
  const auto asleep = outcome_of(
      [](const auto&, const auto&) {
        for (;;) pause();
        return std::string();
      },
      "", 0.1);
  EXPECT_EQ(asleep.end, End::kOutOfTime);
}

TEST(ProcessPool, OneCrashTouchesNoOther) {
  ProcessPool pool(4);
  std::vector<std::string> outcomes(4);
  for (std::size_t i = 0; i < 4; ++i)
    pool.start(
        [](const std::string& bytes, const auto&) -> std::string {
          if (bytes == "1") abort();
          return bytes;
        },
        std::to_string(i), 60.0,
        [&outcomes, i](const ProcessPool::Outcome& o) {
          outcomes[i] = o.end == End::kDone ? o.bytes : "crash";
        });
  while (!pool.idle()) pool.wait(1.0);
  EXPECT_EQ(outcomes, (std::vector<std::string>{"0", "crash", "2", "3"}));
}

/// Job that writes its process id to the pipe whose descriptor is its input, and never ends.
std::string tell_process(const std::string& bytes, const std::atomic<bool>&) {
  const pid_t self = getpid();
  if (write(std::stoi(bytes), &self, sizeof self) == sizeof self) spin_until(nullptr);
  return "";
}

// The endless child inherits the pipe's write end: the pipe closes when the child and the helper have died.
TEST(ProcessPool, AChildDiesWithItsParent) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    close(ends[0]);
    ProcessPool pool(1);
    pool.start(tell_process, std::to_string(ends[1]), 60.0, [](const auto&) {});
    for (;;) pause();
  }
  close(ends[1]);
  pid_t child = 0;
  ASSERT_EQ(read(ends[0], &child, sizeof child), static_cast<ssize_t>(sizeof child)) << "the child runs";
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  pollfd polled{ends[0], POLLIN, 0};
  ASSERT_EQ(poll(&polled, 1, 20000), 1) << "the child still lives";
  char byte = 0;
  EXPECT_EQ(read(ends[0], &byte, 1), 0);
  close(ends[0]);
}

TEST(ProcessPool, AChildDiesWithItsPool) {
  const pid_t parent = fork();
  if (parent == 0) {
    int ends[2];
    if (pipe(ends) != 0) _exit(2);
    pid_t child = 0;
    {
      ProcessPool pool(1);
      pool.start(tell_process, std::to_string(ends[1]), 60.0, [](const auto&) {});
      if (read(ends[0], &child, sizeof child) != sizeof child || kill(child, 0) != 0) _exit(3);
    }
    _exit(kill(child, 0) != 0 && errno == ESRCH ? 0 : 4);
  }
  int status = 1;
  waitpid(parent, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

// A terminal sends Ctrl-C to all processes of the group: only the caller handles it.
TEST(ProcessPool, AnInterruptOfTheGroupEndsNoWork) {
  const pid_t parent = fork();
  if (parent == 0) {
    setpgid(0, 0);
    signal(SIGINT, SIG_IGN);
    std::string answer;
    {
      ProcessPool pool(1);
      pool.start(
          [](const auto&, const auto&) {
            usleep(200000);
            return std::string("done");
          },
          "", 60.0, [&](const ProcessPool::Outcome& o) { answer = o.bytes; });
      kill(0, SIGINT);
      while (!pool.idle()) pool.wait(1.0);
    }
    _exit(answer == "done" ? 0 : 1);
  }
  int status = 1;
  waitpid(parent, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST(ProcessPool, WorkRunsInTheFolderOfItsStart) {
  const auto here = std::filesystem::current_path();
  ProcessPool::prepare();
  std::filesystem::current_path("/");
  const auto outcome =
      outcome_of([](const auto&, const auto&) { return std::filesystem::current_path().string(); });
  std::filesystem::current_path(here);
  EXPECT_EQ(outcome.bytes, "/");
}

TEST(ProcessPool, PoolsSideBySideAndWithinWork) {
  const auto nested = [](const std::string& bytes, const auto&) -> std::string {
    return outcome_of([](const std::string& b, const auto&) { return b + "inner "; }, bytes).bytes + "outer";
  };
  ProcessPool one(1), two(1);
  std::vector<std::string> got;
  const auto keep = [&](const ProcessPool::Outcome& o) { got.push_back(o.bytes); };
  one.start(nested, "1 ", 60.0, keep);
  two.start(nested, "2 ", 60.0, keep);
  while (!two.idle()) two.wait(1.0);
  while (!one.idle()) one.wait(1.0);
  EXPECT_EQ(got, (std::vector<std::string>{"2 inner outer", "1 inner outer"}));
}

/// Result of creating a pool in a process while a second thread runs.
std::string with_a_thread(bool prepared) {
  int ends[2];
  if (pipe(ends) != 0) return "no pipe";
  const pid_t parent = fork();
  if (parent == 0) {
    std::string said;
    if (prepared) ProcessPool::prepare();
    std::atomic<bool> over{false};
    std::thread other([&] { spin_until(&over); });
    try {
      said = outcome_of([](const auto&, const auto&) { return std::string("worked"); }).bytes;
    } catch (const Error& e) { said = e.what(); }
    over = true;
    other.join();
    if (write(ends[1], said.data(), said.size()) < 0) _exit(1);
    _exit(0);
  }
  close(ends[1]);
  std::string said;
  char block[512];
  for (ssize_t n; (n = read(ends[0], block, sizeof block)) > 0;)
    said.append(block, static_cast<std::size_t>(n));
  close(ends[0]);
  waitpid(parent, nullptr, 0);
  return said;
}

TEST(ProcessPool, RefusesToForkAProcessWithThreadsUnlessItWasPrepared) {
  EXPECT_EQ(with_a_thread(true), "worked");
  const std::string refusal = with_a_thread(false);
  EXPECT_NE(refusal.find("this process has 2 threads"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("call palpate::ProcessPool::prepare() at the start of main()"), std::string::npos)
      << refusal;
}

TEST(ProcessPool, AHelperThatDiedIsAClearError) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    close(ends[0]);
    std::string said;
    int go[2];
    if (pipe(go) != 0) _exit(1);
    ProcessPool pool(1);
    pool.start(
        [](const std::string& bytes, const auto&) -> std::string {
          char byte;
          if (read(std::stoi(bytes), &byte, 1) == 1) kill(getppid(), SIGKILL);  // the server process
          for (;;) pause();
        },
        std::to_string(go[0]), 60.0, [&](const ProcessPool::Outcome& o) { said = o.bytes; });
    if (write(go[1], "x", 1) != 1) _exit(1);
    while (!pool.idle()) pool.wait(1.0);
    try {
      pool.start([](const auto&, const auto&) { return std::string(); }, "", 60.0, [](const auto&) {});
    } catch (const Error& e) { said += std::string("; ") + e.what(); }
    if (write(ends[1], said.data(), said.size()) < 0) _exit(1);
    _exit(0);
  }
  close(ends[1]);
  char block[512] = {};
  EXPECT_GT(read(ends[0], block, sizeof block - 1), 0);
  close(ends[0]);
  waitpid(parent, nullptr, 0);
  EXPECT_STREQ(
      block,
      "lost: the process that started it has died; cannot start a process: the server of this pool has died");
}

TEST(Bytes, ComeBackAsTheyWere) {
  palpate::ByteWriter out;
  const VecX v = (VecX(3) << 1.0, -0.0, 1e-300).finished();
  out.put(3L).put(std::string("a\0b", 3)).put(v).put(std::vector<double>{0.1}).put(true);
  const std::string bytes = out.take();
  palpate::ByteReader in(bytes);
  EXPECT_EQ(in.get<long>(), 3);
  EXPECT_EQ(in.get<std::string>(), std::string("a\0b", 3));
  EXPECT_EQ(in.get<VecX>(), v);
  EXPECT_EQ(in.get<std::vector<double>>(), std::vector<double>{0.1});
  EXPECT_TRUE(in.get<bool>());
  EXPECT_TRUE(in.at_end());
  EXPECT_THROW(in.get<double>(), Error);
}

}  // namespace
