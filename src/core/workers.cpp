#include "palpate/core/workers.h"

#include <pthread.h>
#include <sched.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "core/helper_scheduling.h"
#include "core/spin.h"
#include "palpate/core/error.h"

namespace palpate::workers {
namespace {

constexpr int kMost = 256;  ///< Threads.

thread_local int t_count = 0;         ///< Value of the innermost Count or of the running loop; 0 for neither.
thread_local bool t_in_loop = false;  ///< This thread runs a task.

/// Time after which a helper lets others run, between two tasks [ns]: shorter than a time slice, at whose end
/// it would lose its processor with a task begun, and the caller would wait for it.
constexpr std::int64_t kTurnNs = 500'000;
/// Least time between two moves of the helpers away from the caller's processor [ns].
constexpr std::int64_t kBetweenMovesNs = 2'000'000;

// Protocol.  A loop is one word, `ticket_`: its number (32 bits), and the end and the begin (16 bits each) of
// the range of tasks that no thread has taken.  A thread takes a task by replacing the word by its successor
// (compare and exchange): when that succeeds, the loop was open from the load to the exchange, and the loop's
// data read in between are valid, as they change only after its last task is done.  So the caller waits for
// tasks that were begun, and never for threads: a helper that slept through a loop, or lost its processor
// between two tasks, finds the word changed.  (A wrong success would take 2^32 loops between both.)
//
//     caller   data of the loop; done_ = 0; ticket_ = loop; ++wake_; wake all that wait for wake_
//              takes tasks; polls, then waits, until done_ == tasks
//     helper   seen = wake_; ends if stopping_; takes tasks; polls, then waits, while wake_ == seen
//     both     after a task: ++done_; the one that makes it equal to tasks wakes the caller
//
// No wake-up is lost: a helper reads wake_ before it looks for tasks.  Either it finds the loop that the
// caller has opened, or wake_ differs from `seen` by then, and the kernel, which compares both before it lets
// a thread sleep, returns at once.  done_ and the caller are the same case.  stopping_ is set before ++wake_.
// tests/core/pool_protocol_test.cpp explores all interleavings of these steps.
class Pool {
 public:
  ~Pool() { stop(); }

  void run(int tasks, Task task, void* context, Order order) {
    const int threads = count();
    if (tasks > 1 && threads > 1 && !t_in_loop && busy_.try_lock()) {
      const std::scoped_lock lock(std::adopt_lock, busy_);
      grow_locked(threads);
      share(tasks, threads, task, context, order);
      return;
    }
    for (int t = 0; t < tasks; ++t) task(context, t, 0);
  }

  void schedule(int threads, int policy, const sched_param& parameters) {
    const std::scoped_lock lock(busy_);
    grow_locked(threads);
    for (int k = 1; k < threads; ++k)
      pthread_setschedparam(threads_[static_cast<std::size_t>(k) - 1].native_handle(), policy, &parameters);
  }

  long tasks_of(int worker) const { return ran_[static_cast<std::size_t>(worker)].tasks.load(); }

 private:
  int size() const { return size_.load(std::memory_order_relaxed); }
  void grow_locked(int count) {
    if (size() == 1 && count > 1) pthread_getaffinity_np(pthread_self(), sizeof allowed_, &allowed_);
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

  static constexpr int kBits = 16;
  static constexpr std::uint64_t kField = (std::uint64_t{1} << kBits) - 1,
                                 kOneFromEnd = std::uint64_t{1} << kBits;
  static int begin_of(std::uint64_t ticket) { return static_cast<int>(ticket & kField); }
  static int end_of(std::uint64_t ticket) { return static_cast<int>((ticket >> kBits) & kField); }

  void share(int tasks, int threads, Task task, void* context, Order order) {
    PALPATE_CHECK(static_cast<std::uint64_t>(tasks) <= kField, "{} tasks in one loop", tasks);
    task_.store(task, std::memory_order_relaxed);
    context_.store(context, std::memory_order_relaxed);
    tasks_.store(tasks, std::memory_order_relaxed);
    both_ends_.store(order == Order::kFromBothEnds, std::memory_order_relaxed);
    done_.store(0, std::memory_order_relaxed);
    keep_helpers_away(threads);
    threads_of_loop_.store(threads);
    ticket_.store((++loops_ << (2 * kBits)) | (static_cast<std::uint64_t>(tasks) << kBits));
    ++wake_;
    wake_.notify_all();
    take(0);
    if (!spin_until([&] { return done_.load() == tasks; }, processor_of_helper_))
      for (int done = done_.load(); done != tasks; done = done_.load()) done_.wait(done);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

  /// Excludes the caller's processor from those of the helpers.  Linux may wake a helper on it although
  /// others are idle, and leave both there for many time slices: two threads then took turns on one
  /// processor.
  void keep_helpers_away(int threads) {
    const int here = sched_getcpu();
    processor_of_caller_.store(here, std::memory_order_relaxed);
    const bool all_placed = placed_ >= threads;
    if (here == avoided_ && all_placed) return;
    const std::int64_t now = monotonic_ns();
    if (all_placed && now < placed_ns_ + kBetweenMovesNs) return;
    cpu_set_t others = allowed_;
    if (here >= 0) CPU_CLR(static_cast<std::size_t>(here), &others);
    for (int k = 1; k < threads; ++k)
      pthread_setaffinity_np(threads_[static_cast<std::size_t>(k) - 1].native_handle(), sizeof others,
                             CPU_COUNT(&others) > 0 ? &others : &allowed_);
    avoided_ = here;
    placed_ = threads;
    placed_ns_ = now;
  }

  /// Takes tasks until none is left; returns at once where the loop uses fewer threads.
  void take(int worker) {
    std::uint64_t ticket = ticket_.load();
    const int count_outside = t_count;
    t_in_loop = true;
    while (begin_of(ticket) < end_of(ticket)) {
      const int threads = threads_of_loop_.load();
      if (worker >= threads) break;
      const Task task = task_.load(std::memory_order_relaxed);
      void* context = context_.load(std::memory_order_relaxed);
      const int tasks = tasks_.load(std::memory_order_relaxed);
      const bool last_one = worker % 2 == 1 && both_ends_.load(std::memory_order_relaxed);
      if (!ticket_.compare_exchange_weak(ticket, last_one ? ticket - kOneFromEnd : ticket + 1)) continue;
      t_count = threads;
      ran_[static_cast<std::size_t>(worker)].tasks.fetch_add(1, std::memory_order_relaxed);
      if (worker > 0) processor_of_helper_.store(sched_getcpu(), std::memory_order_relaxed);
      perform(task, context, last_one ? end_of(ticket) - 1 : begin_of(ticket), worker);
      if (done_.fetch_add(1) + 1 == tasks) done_.notify_all();
      if (worker > 0) let_others_run();
      ticket = ticket_.load();
    }
    t_in_loop = false;
    t_count = count_outside;
  }

  void perform(Task task, void* context, int index, int worker) noexcept {
    try {
      task(context, index, worker);
    } catch (...) {
      const std::scoped_lock lock(failing_);
      if (failure_ && failed_task_ < index) return;
      failure_ = std::current_exception();
      failed_task_ = index;
    }
  }

  static void let_others_run() {
    thread_local std::int64_t since = 0;
    if (const std::int64_t now = monotonic_ns(); now > since + kTurnNs) {
      sched_yield();
      since = monotonic_ns();
    }
  }

  void serve(int worker) {
    while (true) {
      const unsigned seen = wake_.load();
      if (stopping_.load()) return;
      take(worker);
      const auto woken = [&] { return wake_.load() != seen; };
      if (worker >= threads_of_loop_.load() || !spin_until(woken, processor_of_caller_)) wake_.wait(seen);
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
  std::atomic<int> tasks_{0};
  std::atomic<bool> both_ends_{false};
  std::atomic<int> processor_of_caller_{-1};  ///< when it opened the last loop
  std::atomic<int> processor_of_helper_{-1};  ///< when the last task of a helper began
  cpu_set_t allowed_{};                       ///< processors of the thread that created the first helper
  int avoided_ = -1, placed_ = 1;  ///< the helpers below `placed_` may use all of these but `avoided_`
  std::int64_t placed_ns_ = 0;
  std::uint64_t loops_ = 0;
  std::mutex failing_;
  std::exception_ptr failure_;  ///< of the loop's first task that threw
  int failed_task_ = 0;
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
void run(int tasks, Task task, void* context, Order order) { pool().run(tasks, task, context, order); }
void schedule_helpers(int threads, int policy, const sched_param& parameters) {
  check_count(threads);
  pool().schedule(threads, policy, parameters);
}
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
