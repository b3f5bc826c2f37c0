// Work in processes of its own: what a crash, an endless loop, an exception and a dying parent leave.
#include "palpate/core/process_pool.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "palpate/core/bytes.h"
#include "palpate/core/clock.h"
#include "palpate/core/error.h"

using namespace palpate;
using palpate::ProcessPool;
using End = ProcessPool::Outcome::End;

namespace {

ProcessPool::Outcome outcome_of(ProcessPool::Work work, double limit_s = 60.0) {
  ProcessPool pool(1);
  ProcessPool::Outcome out;
  int calls = 0;
  pool.start(std::move(work), limit_s, [&](const ProcessPool::Outcome& o) { out = o, ++calls; });
  EXPECT_FALSE(pool.has_room());
  while (!pool.idle()) pool.wait(1.0);
  EXPECT_EQ(calls, 1);
  return out;
}

void spin_until(const std::atomic<bool>* flag) {
  volatile double x = 0.0;
  while (!flag || !flag->load()) x = x + 1.0;
}

TEST(ProcessPool, ReturnsBytesWhole) {
  const auto outcome =
      outcome_of([](const auto&) { return std::string(3'000'000, 'x') + std::string("\0end", 4); });
  EXPECT_EQ(outcome.end, End::kDone);
  ASSERT_EQ(outcome.bytes.size(), 3'000'004u);
  EXPECT_EQ(outcome.bytes.substr(3'000'000), std::string("\0end", 4));
}

TEST(ProcessPool, AnExceptionIsItsMessage) {
  const auto outcome = outcome_of([](const auto&) -> std::string { throw Error("no such thing"); });
  EXPECT_EQ(outcome.end, End::kError);
  EXPECT_EQ(outcome.bytes, "no such thing");
}

TEST(ProcessPool, ACrashIsItsSignal) {
  const auto outcome = outcome_of([](const auto&) -> std::string {
    raise(SIGSEGV);
    return "";
  });
  EXPECT_EQ(outcome.end, End::kCrash);
  EXPECT_NE(outcome.bytes.find("killed by signal 11"), std::string::npos) << outcome.bytes;
  const auto left = outcome_of([](const auto&) -> std::string { _exit(3); });
  EXPECT_EQ(left.end, End::kCrash);
  EXPECT_NE(left.bytes.find("exit status 3"), std::string::npos) << left.bytes;
}

TEST(ProcessPool, WorkThatHeedsItsLimitEndsByItself) {
  const auto outcome = outcome_of(
      [](const std::atomic<bool>& late) {
        spin_until(&late);
        return std::string("cut short");
      },
      0.1);
  EXPECT_EQ(outcome.end, End::kDone);
  EXPECT_EQ(outcome.bytes, "cut short");
}

TEST(ProcessPool, WorkThatDoesNotIsKilled) {
  const auto outcome = outcome_of(
      [](const auto&) {
        spin_until(nullptr);
        return std::string();
      },
      0.1);
  EXPECT_EQ(outcome.end, End::kOutOfTime);
  EXPECT_EQ(outcome.bytes, "out of time: 0.1 s");
  // uses no CPU time
  const auto asleep = outcome_of(
      [](const auto&) {
        for (;;) pause();
        return std::string();
      },
      0.1);
  EXPECT_EQ(asleep.end, End::kOutOfTime);
}

TEST(ProcessPool, OneCrashTouchesNoOther) {
  ProcessPool pool(4);
  std::vector<std::string> outcomes(4);
  for (std::size_t i = 0; i < 4; ++i)
    pool.start(
        [i](const auto&) -> std::string {
          if (i == 1) abort();
          return std::to_string(i);
        },
        60.0,
        [&outcomes, i](const ProcessPool::Outcome& o) {
          outcomes[i] = o.end == End::kDone ? o.bytes : "crash";
        });
  while (!pool.idle()) pool.wait(1.0);
  EXPECT_EQ(outcomes, (std::vector<std::string>{"0", "crash", "2", "3"}));
}

// The endless child holds the pipe's other end: it closes when the child has died.
TEST(ProcessPool, AChildDiesWithItsParent) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    close(ends[0]);
    ProcessPool pool(1);
    pool.start(
        [fd = ends[1]](const auto&) {
          if (write(fd, "x", 1) == 1) spin_until(nullptr);
          return std::string();
        },
        60.0, [](const auto&) {});
    for (;;) pause();
  }
  close(ends[1]);
  char byte = 0;
  ASSERT_EQ(read(ends[0], &byte, 1), 1) << "the child runs";
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  pollfd polled{ends[0], POLLIN, 0};
  ASSERT_EQ(poll(&polled, 1, 20000), 1) << "the child still lives";
  EXPECT_EQ(read(ends[0], &byte, 1), 0);
  close(ends[0]);
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
