#pragma once
#include <atomic>
#include <cstdint>

namespace palpate {

/// Whose threads were given work last.  Who waits for more of it spins for a while before it sleeps, as what
/// follows is mostly close; but where another group of threads has been given work since, a spinning thread
/// only keeps one of those from its core: it sleeps at once.
class Turn {
 public:
  Turn() : mine_(next_.fetch_add(1, std::memory_order_relaxed)) {}
  void take() const {
    if (!has()) now_.store(mine_, std::memory_order_relaxed);
  }
  bool has() const { return now_.load(std::memory_order_relaxed) == mine_; }

  /// Looks while one waits, some 50 us on a core of 3 GHz: longer than most serial work between two uses, far
  /// shorter than a time slice.
  static constexpr int kSpins = 4000;

 private:
  std::uint32_t mine_;
  static inline std::atomic<std::uint32_t> next_{1}, now_{0};
};

}  // namespace palpate
