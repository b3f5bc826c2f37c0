#pragma once
#include <type_traits>

/// Thread pool of the process, for loops whose tasks are shared among threads.  It grows to the largest
/// number of threads requested so far; idle threads sleep.  The assignment of tasks to threads is not
/// deterministic: a loop gives bitwise the same numbers with any number of threads if its tasks write to
/// disjoint memory and sums are formed afterwards, task by task.
namespace palpate::workers {

/// Sets the number of threads per loop, including the calling one, where no Count is in force; 1 at the
/// start of the process.  @throws Error outside [1, 256]
void set_count(int count);
/// Returns the number of threads that the calling thread's next loop may use; inside a task, the number of
/// its loop.
int count();

/// Scope in which loops of the constructing thread may use this many threads, including the calling one.
class Count {
 public:
  explicit Count(int count);  ///< @throws Error outside [1, 256]
  ~Count();
  Count(const Count&) = delete;
  Count& operator=(const Count&) = delete;

 private:
  int outside_;
};

/// Task of a loop: index of the task and index of the thread that runs it.  `context` is the pointer passed
/// to run().
using Task = void (*)(void* context, int task, int worker);

/// Which task a thread takes next.
enum class Order {
  kAscending,     ///< the first one that no thread has taken
  kFromBothEnds,  ///< the first one, threads with an odd index the last one: with two threads each one takes
                  ///< nearly the same tasks in every loop, and finds their data in its cache
};

/// Runs task(context, t, w) for every t in [0, tasks), where w in [0, count()) is the index of the thread;
/// returns when all are done.  With one thread, tasks run in ascending order.  A thread without a processor
/// delays the loop only if it has begun a task: all tasks that no other thread has begun are run by the
/// calling one.  Allocates nothing once the pool has its threads, which spin for some tens of microseconds
/// after a loop, then sleep.  A nested loop, and a loop concurrent with one of another thread, runs on the
/// calling thread alone, as w = 0.  If tasks throw, the other tasks are run, and the exception of the first
/// of them, by index, is thrown to the caller; a loop on one thread ends at it.
/// @param tasks  at most 2^16 - 1
/// @param task  may run on any thread
/// @param context  passed to each task
/// @param order  order of the tasks, with several threads
void run(int tasks, Task task, void* context, Order order = Order::kAscending);

/// Returns the number of tasks of shared loops that a thread has run since the process started; worker 0 is
/// the calling thread.
long tasks_of(int worker);

template <class F>
/// Calls run() with a callable f(task, worker).
void for_each(int tasks, F&& f, Order order = Order::kAscending) {
  using Function = std::remove_reference_t<F>;
  run(
      tasks, [](void* context, int task, int worker) { (*static_cast<Function*>(context))(task, worker); },
      const_cast<std::remove_const_t<Function>*>(&f), order);
}

}  // namespace palpate::workers
