#include "palpate/core/workers.h"

#include <pthread.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "core/spin.h"
#include "palpate/core/error.h"

namespace palpate::workers {
namespace {

constexpr int kMost = 256;  ///< Threads.

thread_local int t_count = 0;         ///< Value of the innermost Count or of the running loop; 0 for neither.
thread_local bool t_in_loop = false;  ///< This thread runs a task.

// The word `ticket_` packs the loop's number (24 bits), its number of tasks and the next task (20 bits each).
// A thread takes a task by replacing the word by its successor (compare and exchange): when that succeeds,
// the loop was open from the load to the exchange, and the loop's data read in between are valid.  So the
// caller need not wait for threads that slept through the loop, only for the tasks.
class Pool {
 public:
  ~Pool() { stop(); }

  void run(int tasks, Task task, void* context) {
    const int threads = count();
    if (tasks > 1 && threads > 1 && !t_in_loop && busy_.try_lock()) {
      const std::scoped_lock lock(std::adopt_lock, busy_);
      grow_locked(threads);
      share(tasks, threads, task, context);
      return;
    }
    for (int t = 0; t < tasks; ++t) task(context, t, 0);
  }

  void run_together(int threads, Task task, void* context) {
    PALPATE_CHECK(!t_in_loop, "{} threads are to work together inside a loop", threads);
    const std::scoped_lock lock(busy_);
    grow_locked(threads);
    share(threads, threads, task, context);
  }

  long tasks_of(int worker) const { return ran_[static_cast<std::size_t>(worker)].tasks.load(); }

 private:
  int size() const { return size_.load(std::memory_order_relaxed); }
  void grow_locked(int count) {
    for (int worker = size(); worker < count; ++worker) {
      try {
        threads_.emplace_back([this, worker] { serve(worker); });
      } catch (const std::system_error& e) {
        fail(
            "thread {} of {} cannot be started ({}); lower integrator.threads, or raise the limits on "
            "address space (ulimit -v) and processes (ulimit -u)",
            worker + 1, count, e.code().message());
      }
      size_ = worker + 1;
    }
  }

  static constexpr std::uint64_t kBits = 20, kField = (std::uint64_t{1} << kBits) - 1;
  static std::uint64_t next_of(std::uint64_t ticket) { return ticket & kField; }
  static std::uint64_t tasks_of(std::uint64_t ticket) { return (ticket >> kBits) & kField; }

  void share(int tasks, int threads, Task task, void* context) {
    PALPATE_CHECK(static_cast<std::uint64_t>(tasks) <= kField, "{} tasks in one loop", tasks);
    task_.store(task, std::memory_order_relaxed);
    context_.store(context, std::memory_order_relaxed);
    done_.store(0, std::memory_order_relaxed);
    threads_of_loop_.store(threads);
    ticket_.store((++loops_ << (2 * kBits)) | (static_cast<std::uint64_t>(tasks) << kBits));
    ++wake_;
    wake_.notify_all();
    take(0);
    for (int spins = 0;; ++spins) {
      const int done = done_.load();
      if (done == tasks) return;
      if (spins < kSpins)
        spin_once();
      else
        done_.wait(done);
    }
  }

  /// Takes tasks until none is left; returns at once where the loop uses fewer threads.
  void take(int worker) {
    std::uint64_t ticket = ticket_.load();
    const int count_outside = t_count;
    t_in_loop = true;
    while (next_of(ticket) < tasks_of(ticket)) {
      const int threads = threads_of_loop_.load();
      if (worker >= threads) break;
      const Task task = task_.load(std::memory_order_relaxed);
      void* context = context_.load(std::memory_order_relaxed);
      if (!ticket_.compare_exchange_weak(ticket, ticket + 1)) continue;
      t_count = threads;
      ran_[static_cast<std::size_t>(worker)].tasks.fetch_add(1, std::memory_order_relaxed);
      task(context, static_cast<int>(next_of(ticket)), worker);
      if (done_.fetch_add(1) + 1 == static_cast<int>(tasks_of(ticket))) done_.notify_all();
      ticket = ticket_.load();
    }
    t_in_loop = false;
    t_count = count_outside;
  }

  void serve(int worker) {
    while (true) {
      const unsigned seen = wake_.load();
      if (stopping_.load()) return;
      take(worker);
      if (worker < threads_of_loop_.load())
        for (int spins = 0; wake_.load() == seen && spins < kSpins; ++spins) spin_once();
      wake_.wait(seen);
    }
  }

  void stop() {
    stopping_ = true;
    ++wake_;
    wake_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

  std::mutex busy_;
  std::vector<std::thread> threads_;
  std::atomic<int> size_{1}, threads_of_loop_{1};
  std::atomic<bool> stopping_{false};
  std::atomic<unsigned> wake_{0};
  std::atomic<std::uint64_t> ticket_{0};
  std::atomic<int> done_{0};
  std::atomic<Task> task_{nullptr};
  std::atomic<void*> context_{nullptr};
  std::uint64_t loops_ = 0;
  struct alignas(64) Ran {
    std::atomic<long> tasks{0};
  };
  std::array<Ran, kMost> ran_;
};

std::atomic<Pool*> g_pool{nullptr};
std::atomic<int> g_count{1};

/// Creates the pool, and a new one in a forked child: there the threads are gone, and a lost thread may hold
/// the mutex.  The parent's pool is left as it is.
struct FirstPool {
  FirstPool() : own(new Pool) {
    g_pool = own;
    pthread_atfork(nullptr, nullptr, [] { g_pool = new Pool; });
  }
  ~FirstPool() {
    if (g_pool == own) delete own;
  }
  Pool* own;
};

Pool& pool() {
  static const FirstPool first;
  return *g_pool;
}

void check_count(int count) {
  if (count < 1 || count > kMost) fail("threads = {} must lie in [1, {}]", count, kMost);
}

}  // namespace

void set_count(int count) {
  check_count(count);
  g_count = count;
}
int count() { return t_count > 0 ? t_count : g_count.load(std::memory_order_relaxed); }
void run(int tasks, Task task, void* context) { pool().run(tasks, task, context); }
void run_together(int threads, Task task, void* context) { pool().run_together(threads, task, context); }
long tasks_of(int worker) {
  PALPATE_CHECK(worker >= 0 && worker < kMost, "thread {}", worker);
  return pool().tasks_of(worker);
}

Count::Count(int count) : outside_(t_count) {
  check_count(count);
  t_count = count;
}
Count::~Count() { t_count = outside_; }

}  // namespace palpate::workers
