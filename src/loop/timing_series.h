#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace palpate::loop {

/// Timings of a run, oldest first; of more than `capacity` of them the newest are kept. All memory is
/// allocated at the start, so that a tick allocates none.
class TimingSeries {
 public:
  /// Number of timings that a run without an end keeps: 17 minutes at 1 kHz.
  static constexpr std::size_t kEndless = std::size_t{1} << 20;

  /// @param values  receives the timings  @param count  receives their number; both must outlive this object
  TimingSeries(std::vector<float>& values, long& count, std::size_t capacity)
      : values_(values), count_(count), capacity_(capacity) {
    values_.reserve(capacity);
  }
  void add(float value) {
    if (values_.size() < capacity_)
      values_.push_back(value);
    else
      values_[static_cast<std::size_t>(count_) % capacity_] = value;
    ++count_;
  }
  /// Puts the kept timings into their order; to be called once, after the last add().
  void close() {
    if (static_cast<std::size_t>(count_) > values_.size())
      std::rotate(values_.begin(), values_.begin() + count_ % static_cast<long>(capacity_), values_.end());
  }

 private:
  std::vector<float>& values_;
  long& count_;
  std::size_t capacity_;
};

}  // namespace palpate::loop
