#pragma once
#include <algorithm>

namespace palpate::loop {

/// Decides in real time whether steps use the other threads of the pool. Threads that work together wait for
/// each other at every barrier, some hundred times per step; where another program keeps one of their
/// processors busy, each barrier may cost a time slice of some milliseconds. A step with more than kMostWaits
/// waits beyond spinning (core/late_helpers.h) is followed by kAlone steps on one thread, and by twice as
/// many as the last time if that happens again within kAlone steps. Results are bitwise the same.
class HelperWatch {
 public:
  static constexpr long kMostWaits = 3, kAlone = 256, kLongest = 4096;

  /// Returns whether the next step is to be taken on one thread.
  bool alone() const { return left_ > 0; }
  /// Records the number of long waits of a step.
  void end(long waits) {
    if (left_ > 0) {
      --left_;
      since_ = 0;
      return;
    }
    ++since_;
    if (waits <= kMostWaits) return;
    length_ = since_ <= kAlone && length_ > 0 ? std::min(2 * length_, kLongest) : kAlone;
    left_ = length_;
  }

 private:
  long left_ = 0, length_ = 0, since_ = 0;
};

}  // namespace palpate::loop
