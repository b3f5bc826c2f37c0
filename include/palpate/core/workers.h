#pragma once
#include <type_traits>

/// The threads of the process: one pool, for loops whose tasks are shared (here) and for teams that work on
/// one computation together (team.h).  It grows to the largest number that anyone asked for, and idle threads
/// sleep. Which thread runs which task of a loop is not determined: a loop whose tasks write to disjoint
/// memory, and whose sums are formed task by task afterwards, gives the same numbers to the last bit with any
/// number of threads.
namespace palpate::workers {

/// Threads that a loop may use, the caller's included, where no Count says otherwise; 1 at the start of the
/// process.  @throws Error outside [1, 256]
void set_count(int count);
/// Number of threads that the calling thread's next loop may use; inside a task, that of its loop.
int count();

/// While it lives, loops of the thread that made it may use this many threads, the caller's included.
class Count {
 public:
  explicit Count(int count);  ///< @throws Error outside [1, 256]
  ~Count();
  Count(const Count&) = delete;
  Count& operator=(const Count&) = delete;

 private:
  int outside_;
};

/// One task of a loop: its number, and that of the thread that runs it.  `context` is whatever run() was
/// given.
using Task = void (*)(void* context, int task, int worker);

/// Runs task(context, t, w) for every t in [0, tasks), w in [0, count()) naming the thread; returns when all
/// are done.  One thread takes them in their order.  Allocates nothing once the pool has its threads, which
/// spin for some tens of microseconds after a loop, then sleep.  A loop inside a loop, or concurrent with one
/// of another thread, is run by its caller alone, as w = 0.  Tasks must not throw.
/// @param tasks  at most 2^20 - 1  @param task  may run on any thread  @param context  handed to each task
void run(int tasks, Task task, void* context);

/// Runs task(context, k, w) for every k in [0, threads), each on a thread of its own: they may wait for each
/// other.  Waits while another thread has the pool.  Not inside a task.
void run_together(int threads, Task task, void* context);

/// Tasks of shared loops that a thread has run since the process started; 0 is the caller's thread.
long tasks_of(int worker);

template <class F>
/// run() of a callable f(task, worker).
void for_each(int tasks, F&& f) {
  using Function = std::remove_reference_t<F>;
  run(
      tasks, [](void* context, int task, int worker) { (*static_cast<Function*>(context))(task, worker); },
      const_cast<std::remove_const_t<Function>*>(&f));
}

}  // namespace palpate::workers
