#pragma once
#include <type_traits>

/// A few threads that share the tasks of one loop.  Who runs which task is left to chance: a loop whose tasks
/// write apart from each other, and whose sums are formed task by task afterwards, gives the same numbers to
/// the last bit with any number of threads.
namespace palpate::workers {

/// Threads that a loop may use, the caller's included; 1 at the start of the process.  Not while a loop runs.
/// @throws Error outside [1, 256]
void set_count(int count);
int count();

/// Runs task(context, t, w) for every t in [0, tasks), w in [0, count()) naming the thread; returns when all
/// are done.  One thread takes them in their order.  Allocates nothing.  Idle threads spin for some tens of
/// microseconds, then sleep.  A loop inside a loop, or beside one in another thread, is run by its caller
/// alone, as w = 0. Tasks must not throw.  @param tasks  at most 2^20 - 1
using Task = void (*)(void* context, int task, int worker);
void run(int tasks, Task task, void* context);

template <class F>
void for_each(int tasks, F&& f) {
  using Function = std::remove_reference_t<F>;
  run(
      tasks, [](void* context, int task, int worker) { (*static_cast<Function*>(context))(task, worker); },
      const_cast<std::remove_const_t<Function>*>(&f));
}

}  // namespace palpate::workers
