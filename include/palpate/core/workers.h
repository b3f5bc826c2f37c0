#pragma once
#include <type_traits>

/// Thread pool of the process, for loops whose tasks are shared (here) and for teams that work on one
/// computation together (team.h).  It grows to the largest number of threads requested so far; idle threads
/// sleep.  The assignment of tasks to threads is not deterministic: a loop gives bitwise the same numbers
/// with any number of threads if its tasks write to disjoint memory and sums are formed afterwards, task by
/// task.
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

/// Runs task(context, t, w) for every t in [0, tasks), where w in [0, count()) is the index of the thread;
/// returns when all are done.  With one thread, tasks run in ascending order.  Allocates nothing once the
/// pool has its threads, which spin for some tens of microseconds after a loop, then sleep.  A nested loop,
/// and a loop concurrent with one of another thread, runs on the calling thread alone, as w = 0.  Tasks must
/// not throw.
/// @param tasks  at most 2^20 - 1
/// @param task  may run on any thread
/// @param context  passed to each task
void run(int tasks, Task task, void* context);

/// Runs task(context, k, w) for every k in [0, threads), each on a separate thread, so that tasks may wait
/// for each other.  Blocks while another thread uses the pool.  Must not be called inside a task.
void run_together(int threads, Task task, void* context);

/// Returns the number of tasks of shared loops that a thread has run since the process started; worker 0 is
/// the calling thread.
long tasks_of(int worker);

template <class F>
/// Calls run() with a callable f(task, worker).
void for_each(int tasks, F&& f) {
  using Function = std::remove_reference_t<F>;
  run(
      tasks, [](void* context, int task, int worker) { (*static_cast<Function*>(context))(task, worker); },
      const_cast<std::remove_const_t<Function>*>(&f));
}

}  // namespace palpate::workers
