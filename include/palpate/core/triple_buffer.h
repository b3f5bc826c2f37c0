#pragma once
#include <array>
#include <atomic>
#include <type_traits>

namespace palpate {

/// Lock-free exchange of records between one writer thread and one reader thread. The reader always receives
/// a complete record and never waits (triple buffer: the writer fills its back slot and swaps it with the
/// middle one).
template <class Record>
class TripleBuffer {
  static_assert(std::is_trivially_copyable_v<Record>);

 public:
  /// Publishes a copy of the record as the newest one. Called by the writer's thread only.
  void publish(const Record& record) {
    slots_[back_] = record;
    back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }
  /// Returns the newest record published so far. Called by the reader's thread only; the reference is valid
  /// until the next call.
  const Record& latest() {
    if (middle_.load(std::memory_order_relaxed) & kFresh)
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return slots_[front_];
  }

 private:
  static constexpr unsigned kFresh = 4, kIndex = 3;
  std::array<Record, 3> slots_{};
  unsigned back_ = 0;
  std::atomic<unsigned> middle_{1};
  unsigned front_ = 2;
};

}  // namespace palpate
