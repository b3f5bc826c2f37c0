#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <type_traits>
#include <vector>

namespace palpate {

/// A few threads that work on one thing together, again and again: the caller and size() - 1 workers, which
/// live as long as the team. Who waits spins for some tens of microseconds and then sleeps: on a machine with
/// fewer free cores than threads a spinning team costs seconds.
/// One caller at a time.  What a worker throws ends the program: give it work that does not throw.
class Team {
 public:
  explicit Team(int size);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;
  int size() const { return size_; }

  /// Calls work(k) for k = 0 ... size() - 1, one thread each, the caller as 0; returns when all have
  /// returned.  Allocates nothing.
  template <class Work>
  void run(Work&& work) {
    using W = std::remove_reference_t<Work>;
    run_any([](void* w, int k) { (*static_cast<W*>(w))(k); }, const_cast<std::remove_const_t<W>*>(&work));
  }
  /// Inside run: waits until every thread has come here.
  void barrier();

 private:
  void run_any(void (*call)(void*, int), void* work);
  void live(int k);
  void wait_while(const std::atomic<std::uint32_t>& value, std::uint32_t old) const;

  struct Group;
  int size_;
  std::unique_ptr<Group> group_;
  std::vector<std::thread> workers_;
  void (*call_)(void*, int) = nullptr;
  void* work_ = nullptr;
  bool ended_ = false;
  std::atomic<std::uint32_t> round_{0}, phase_{0}, arrived_{0};
};

}  // namespace palpate
