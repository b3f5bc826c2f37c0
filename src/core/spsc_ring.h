#pragma once
#include <atomic>
#include <bit>
#include <cstddef>
#include <vector>

namespace palpate {

/// Bounded lock-free queue between one writing and one reading thread (Lamport 1983): each index is written
/// by one side alone.  Memory is allocated once, at construction.
template <class T>
class SpscRing {
 public:
  /// @param capacity  minimum number of entries; rounded up to a power of two
  explicit SpscRing(std::size_t capacity) : slots_(std::bit_ceil(capacity)) {}

  /// Appends a value (writing thread).  Returns false, without any change, where the ring is full.
  bool push(const T& value) {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == slots_.size()) return false;
    slots_[end & (slots_.size() - 1)] = value;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }

  /// Removes the oldest value (reading thread).  Returns false where the ring is empty.
  bool pop(T& value) {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return false;
    value = slots_[begin & (slots_.size() - 1)];
    begin_.store(begin + 1, std::memory_order_release);
    return true;
  }

  std::size_t capacity() const { return slots_.size(); }

 private:
  std::vector<T> slots_;
  alignas(64) std::atomic<std::size_t> begin_{0};  ///< Index of the reader.
  alignas(64) std::atomic<std::size_t> end_{0};    ///< Index of the writer.
};

}  // namespace palpate
