#pragma once

namespace palpate::workers {

/// Returns how often the calling thread had to sleep in a loop or at a barrier because other threads of the
/// pool had not finished: they were given no processor, or had much more work. The sum since the thread
/// started.
long long_waits();
/// Adds one to long_waits().
void count_long_wait();

/// Scope in which the constructing thread works alone: its loops and teams use no other thread. Results are
/// bitwise the same. Must not be nested.
class Alone {
 public:
  Alone();
  ~Alone();
  Alone(const Alone&) = delete;
  Alone& operator=(const Alone&) = delete;
};
/// Returns whether the calling thread is in such a scope.
bool alone();

}  // namespace palpate::workers
