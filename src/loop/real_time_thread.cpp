#include "real_time_thread.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <time.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "core/helper_scheduling.h"

namespace palpate::loop {
namespace {

constexpr int kPriority = 80;              // above the 50 of interrupt threads on PREEMPT_RT kernels
constexpr std::size_t kStack = 256 << 10;  // touched in advance [bytes]

void pin(RealTimeResult& out) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (pthread_getaffinity_np(pthread_self(), sizeof allowed, &allowed) != 0) return;
  if (CPU_COUNT(&allowed) < 2) return;  // the bodies need a processor, too
  std::size_t last = 0;
  for (std::size_t i = 0; i < CPU_SETSIZE; ++i)
    if (CPU_ISSET(i, &allowed)) last = i;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(last, &one);
  if (pthread_setaffinity_np(pthread_self(), sizeof one, &one) == 0) out.cpu = static_cast<int>(last);
}

void schedule(RealTimeResult& out) {
  sched_param priority{};
  priority.sched_priority = kPriority;
  const int refused = pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
  out.scheduling =
      refused == 0
          ? fmt::format("SCHED_FIFO {}", kPriority)
          : fmt::format(
                "SCHED_OTHER (SCHED_FIFO not permitted: {}; run as root, or raise \"ulimit -r\" to {})",
                std::strerror(refused), kPriority);
}

// Locks the current pages only: ticks allocate no new ones. Locking future pages (MCL_FUTURE) would make
// allocations in the bodies' thread fail beyond RLIMIT_MEMLOCK.
void lock_memory(RealTimeResult& out) {
  out.memory = mlockall(MCL_CURRENT) == 0
                   ? "locked"
                   : fmt::format("not locked ({}; raise \"ulimit -l\")", std::strerror(errno));
}

[[gnu::noinline]] void touch_stack() {
  std::array<char, kStack> stack;
  volatile char* p = stack.data();
  for (std::size_t i = 0; i < kStack; i += 1024) p[i] = 0;
}

// CLOCK_MONOTONIC does not count time in suspension.
constexpr clockid_t kClock = CLOCK_BOOTTIME;

}  // namespace

std::int64_t now_ns() {
  timespec t{};
  clock_gettime(kClock, &t);
  return std::int64_t{1'000'000'000} * t.tv_sec + t.tv_nsec;
}

void sleep_until_ns(std::int64_t due) {
  const timespec t{due / 1'000'000'000, due % 1'000'000'000};
  while (clock_nanosleep(kClock, TIMER_ABSTIME, &t, nullptr) == EINTR) {}
}

std::int64_t wait_for_the_end_of_a_pause(const std::atomic<bool>& pause, const std::function<bool()>& ended) {
  const std::int64_t start = now_ns();
  while (pause.load(std::memory_order_relaxed) && !ended()) sleep_until_ns(now_ns() + 1'000'000);
  return now_ns() - start;
}

void claim_real_time(RealTimeResult& out) {
  touch_stack();
  pin(out);
  schedule(out);
  lock_memory(out);
}

void release_memory() { munlockall(); }

RealTimeClaim::RealTimeClaim(RealTimeResult& out, int threads) : threads_(threads) {
  pthread_getaffinity_np(pthread_self(), sizeof processors_, &processors_);
  pthread_getschedparam(pthread_self(), &policy_, &parameters_);
  sched_param helpers{};
  helpers.sched_priority = kPriority - 1;
  // The loop waits for a helper that has begun a task. Where SCHED_FIFO is not permitted helpers stay as they
  // are.
  if (threads_ > 1) workers::schedule_helpers(threads_, SCHED_FIFO, helpers);
  claim_real_time(out);
}

RealTimeClaim::~RealTimeClaim() {
  if (threads_ > 1) workers::schedule_helpers(threads_, policy_, parameters_);
  pthread_setschedparam(pthread_self(), policy_, &parameters_);
  pthread_setaffinity_np(pthread_self(), sizeof processors_, &processors_);
  release_memory();
}

}  // namespace palpate::loop
