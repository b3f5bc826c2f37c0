#include "palpate/core/workers.h"

#include <atomic>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "core/active_group.h"
#include "palpate/core/error.h"

namespace palpate::workers {
namespace {

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#else
  std::this_thread::yield();
#endif
}

// One word, `ticket_`, holds the loop's number (24 bits), its tasks and the next of them (20 bits each).  A
// thread that takes a task swaps the word for its successor: when that succeeds, the loop was open all the
// while between the two looks at the word, and with it what was read of the loop in between.  So the caller
// need not wait for threads that slept through the loop, only for the tasks.
class Pool {
 public:
  ~Pool() { stop(); }
  int count() const { return count_.load(std::memory_order_relaxed); }

  void resize(int count) {
    const std::scoped_lock lock(busy_);
    if (count == this->count()) return;
    stop();
    count_ = count;
    for (int worker = 1; worker < count; ++worker) threads_.emplace_back([this, worker] { serve(worker); });
  }

  void run(int tasks, Task task, void* context) {
    if (tasks > 1 && count() > 1 && busy_.try_lock()) {
      const std::scoped_lock lock(std::adopt_lock, busy_);
      share(tasks, task, context);
      return;
    }
    for (int t = 0; t < tasks; ++t) task(context, t, 0);
  }

 private:
  static constexpr std::uint64_t kBits = 20, kField = (std::uint64_t{1} << kBits) - 1;
  static std::uint64_t next_of(std::uint64_t ticket) { return ticket & kField; }
  static std::uint64_t tasks_of(std::uint64_t ticket) { return (ticket >> kBits) & kField; }

  void share(int tasks, Task task, void* context) {
    PALPATE_CHECK(static_cast<std::uint64_t>(tasks) <= kField, "{} tasks in one loop", tasks);
    group_.activate();
    task_.store(task, std::memory_order_relaxed);
    context_.store(context, std::memory_order_relaxed);
    done_.store(0, std::memory_order_relaxed);
    ticket_.store((++loops_ << (2 * kBits)) | (static_cast<std::uint64_t>(tasks) << kBits));
    ++wake_;
    wake_.notify_all();
    take(0);
    for (int spins = 0;; ++spins) {
      const int done = done_.load();
      if (done == tasks) return;
      if (spins < ActiveGroup::kSpins)
        pause();
      else
        done_.wait(done);
    }
  }

  /// Takes tasks until none is left.
  void take(int worker) {
    std::uint64_t ticket = ticket_.load();
    while (next_of(ticket) < tasks_of(ticket)) {
      const Task task = task_.load(std::memory_order_relaxed);
      void* context = context_.load(std::memory_order_relaxed);
      if (!ticket_.compare_exchange_weak(ticket, ticket + 1)) continue;
      task(context, static_cast<int>(next_of(ticket)), worker);
      if (done_.fetch_add(1) + 1 == static_cast<int>(tasks_of(ticket))) done_.notify_all();
      ticket = ticket_.load();
    }
  }

  void serve(int worker) {
    while (true) {
      const unsigned seen = wake_.load();
      if (stopping_.load()) return;
      take(worker);
      for (int spins = 0; wake_.load() == seen && spins < ActiveGroup::kSpins && group_.is_active(); ++spins)
        pause();
      wake_.wait(seen);
    }
  }

  void stop() {
    stopping_ = true;
    ++wake_;
    wake_.notify_all();
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
    stopping_ = false;
  }

  ActiveGroup group_;
  std::mutex busy_;
  std::vector<std::thread> threads_;
  std::atomic<int> count_{1};
  std::atomic<bool> stopping_{false};
  std::atomic<unsigned> wake_{0};
  std::atomic<std::uint64_t> ticket_{0};
  std::atomic<int> done_{0};
  std::atomic<Task> task_{nullptr};
  std::atomic<void*> context_{nullptr};
  std::uint64_t loops_ = 0;
};

Pool& pool() {
  static Pool one;
  return one;
}

}  // namespace

void set_count(int count) {
  if (count < 1 || count > 256) fail("threads = {} must lie in [1, 256]", count);
  pool().resize(count);
}
int count() { return pool().count(); }
void run(int tasks, Task task, void* context) { pool().run(tasks, task, context); }

}  // namespace palpate::workers
