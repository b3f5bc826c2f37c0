// Shared loops where threads lose their processors at arbitrary times: no task is lost or run twice, no
// thread sleeps for ever.
#include <dirent.h>
#include <sched.h>
#include <signal.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "palpate/core/workers.h"

using namespace palpate;

namespace {

/// Factor on the number of loops, for longer runs: PALPATE_STRESS=100 core_test
/// --gtest_filter='WorkersStress.*'
int stress() {
  const char* factor = std::getenv("PALPATE_STRESS");
  return factor ? std::max(1, std::atoi(factor)) : 1;
}
/// A loop that hangs ends the child with SIGALRM.
unsigned seconds_to_end() { return 300u * static_cast<unsigned>(stress()); }

/// Polls for a while; lets another thread run, or sleeps, now and then.
void pause_for(std::minstd_rand& random) {
  const unsigned kind = static_cast<unsigned>(random()) % 64;
  if (kind == 0) std::this_thread::sleep_for(std::chrono::microseconds(random() % 60));
  if (kind < 20) std::this_thread::yield();
  const auto most_polls = kind > 60 ? 30000u : 300u;
  for (auto i = static_cast<unsigned>(random()) % most_polls; i > 0; --i)
    std::atomic_signal_fence(std::memory_order_seq_cst);
}

/// Runs `rounds` loops of few tasks with pauses of random length within and between them. Returns the number
/// of loops in which a task did not run exactly once.
int wrong_loops(int threads, int rounds, unsigned seed) {
  const workers::Count count(threads);
  std::minstd_rand random(seed);
  int wrong = 0;
  for (int round = 0; round < rounds; ++round) {
    std::atomic<int> runs[8] = {};
    const int tasks = 1 + static_cast<int>(random() % 8);
    const unsigned loop_seed = static_cast<unsigned>(random());
    workers::for_each(
        tasks,
        [&](int task, int) {
          std::minstd_rand own(loop_seed + static_cast<unsigned>(task));
          pause_for(own);
          ++runs[task];
        },
        round % 2 == 0 ? workers::Order::kAscending : workers::Order::kFromBothEnds);
    bool good = true;
    for (int t = 0; t < 8; ++t) good &= runs[t] == (t < tasks ? 1 : 0);
    wrong += !good;
    pause_for(random);
  }
  return wrong;
}

/// Calls visit(thread id) for all threads of a process but the first one.
void for_other_threads(pid_t process, const std::function<void(pid_t)>& visit) {
  DIR* folder = opendir(("/proc/" + std::to_string(process) + "/task").c_str());
  if (!folder) return;
  while (const dirent* entry = readdir(folder))
    if (const pid_t id = std::atoi(entry->d_name); id > 0 && id != process) visit(id);
  closedir(folder);
}

/// Runs work() in a child; returns its exit code, 1000 + the signal that ended it. disturb(process) is called
/// until it ends.
int in_child(const std::function<int()>& work, const std::function<void(pid_t)>& disturb = nullptr) {
#if defined(__SANITIZE_THREAD__)  // which supports no threads in a forked child
  int code = 0;
  std::thread([&] { code = work(); }).join();
  (void)disturb;
  return code;
#else
  const pid_t child = fork();
  if (child == 0) {
    alarm(seconds_to_end());
    std::_Exit(work());
  }
  int status = 0;
  while (waitpid(child, &status, disturb ? WNOHANG : 0) == 0) disturb(child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
#endif
}

/// Returns the number of wrong loops, at most 100.
int work(int threads, int rounds) { return std::min(wrong_loops(threads, stress() * rounds, 7), 100); }

void use_one_processor() {
  cpu_set_t all, one;
  sched_getaffinity(0, sizeof all, &all);
  CPU_ZERO(&one);
  for (int i = 0; i < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++i)
    if (CPU_ISSET(i, &all)) CPU_SET(i, &one);
  sched_setaffinity(0, sizeof one, &one);  // threads created from now on inherit it
}

}  // namespace

TEST(WorkersStress, RandomPauses) {
  for (const int threads : {2, 3, 5}) {
    EXPECT_EQ(in_child([&] {
                const int wrong = work(threads, 3000);
                return workers::tasks_of(1) > 0 ? wrong : 101;  // the helpers take part
              }),
              0)
        << threads;
  }
}

TEST(WorkersStress, AllThreadsOnOneProcessor) {
  for (const int threads : {2, 4}) {
    EXPECT_EQ(in_child([&] {
                use_one_processor();
                return work(threads, 3000);
              }),
              0)
        << threads;
  }
}

// Where two threads begin loops at the same time, one of them runs its loop alone.
TEST(WorkersStress, TwoCallersOnOneProcessor) {
  EXPECT_EQ(in_child([] {
              use_one_processor();
              int of_other = 0;
              std::thread other([&] { of_other = work(2, 3000); });
              const int own = work(3, 3000);
              other.join();
              return own + of_other;
            }),
            0);
}

TEST(WorkersStress, HelpersOfIdlePriority) {
  EXPECT_EQ(in_child([] { return work(2, 3000); },
                     [](pid_t process) {
                       const sched_param none{};
                       for_other_threads(process,
                                         [&](pid_t id) { sched_setscheduler(id, SCHED_IDLE, &none); });
                       std::this_thread::sleep_for(std::chrono::milliseconds(1));
                     }),
            0);
}

TEST(WorkersStress, ThreadsMovedAndProcessStopped) {
  EXPECT_EQ(in_child([] { return work(3, 3000); },
                     [random = std::minstd_rand(3)](pid_t process) mutable {
                       kill(process, SIGSTOP);
                       std::this_thread::sleep_for(std::chrono::microseconds(random() % 300));
                       for_other_threads(process, [&](pid_t id) {
                         cpu_set_t one;
                         CPU_ZERO(&one);
                         CPU_SET(random() % std::max(1u, std::thread::hardware_concurrency()), &one);
                         sched_setaffinity(id, sizeof one, &one);
                       });
                       kill(process, SIGCONT);
                       std::this_thread::sleep_for(std::chrono::microseconds(random() % 500));
                     }),
            0);
}

// A process that ends while its helpers poll, or go to sleep.
TEST(WorkersStress, EndsWhileHelpersWait) {
#if defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the thread sanitizer supports no threads in a forked child";
#endif
  for (int repeat = 0; repeat < 50; ++repeat) {
    const pid_t child = fork();
    if (child == 0) {
      alarm(seconds_to_end());
      const workers::Count count(3);
      std::minstd_rand random(static_cast<unsigned>(repeat) + 1);
      workers::for_each(20, [](int, int) {});
      for (int i = 0; i < 10; ++i) pause_for(random);
      std::exit(0);  // runs static destructors
    }
    int status = -1;
    waitpid(child, &status, 0);
    ASSERT_EQ(status, 0) << repeat;
  }
}
