#pragma once
#include <atomic>
#include <cstdint>

namespace palpate {

/// Tells a thread group whether it was the last one to be given work.  A thread that waits for work spins for
/// a while before it sleeps, as the next work mostly follows at once.  Where another group has been given
/// work since, a spinning thread would only take a core from that group: it sleeps at once.
class ActiveGroup {
 public:
  ActiveGroup() : id_(next_id_.fetch_add(1, std::memory_order_relaxed)) {}
  void activate() const {
    if (!is_active()) active_.store(id_, std::memory_order_relaxed);
  }
  bool is_active() const { return active_.load(std::memory_order_relaxed) == id_; }

  /// Polls of a spinning thread, about 50 us on a core of 3 GHz: longer than most serial work between two
  /// loops, far shorter than a time slice.
  static constexpr int kSpins = 4000;

 private:
  std::uint32_t id_;
  static inline std::atomic<std::uint32_t> next_id_{1}, active_{0};
};

}  // namespace palpate
