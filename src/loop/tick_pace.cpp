#include "tick_pace.h"

#include <algorithm>
#include <cmath>

namespace palpate::loop {
namespace {
/// Weight of a step in the mean, and the largest multiple of the mean that enters it: one interruption does
/// not count as overload.
constexpr double kWeight = 1.0 / 32.0, kMostOfMean = 8.0;
}  // namespace

long TickPace::begin(std::int64_t late_ns) {
  const auto tick = static_cast<double>(tick_ns_);
  const long behind = static_cast<long>(late_ns / tick_ns_);
  if (behind < kMostBehind) return 0;
  if (mean_ns_ > kMostLoad * tick * static_cast<double>(stride_) && stride_ < most_) {
    const auto enough = static_cast<long>(std::ceil(mean_ns_ / (kMostLoad * tick)));
    change_to(std::min(most_, std::max(stride_ + 1, enough)));
    return std::max(0L, behind - kMostBehind);
  }
  return behind;
}

void TickPace::end(std::int64_t work_ns) {
  const auto work = static_cast<double>(work_ns), tick = static_cast<double>(tick_ns_);
  if (mean_ns_ == 0.0) mean_ns_ = work;
  mean_ns_ += kWeight * (std::min(work, kMostOfMean * mean_ns_) - mean_ns_);
  if (++since_change_ < kCalm || stride_ == 1) return;
  since_change_ = 0;
  if (mean_ns_ < kMostLoad * tick * static_cast<double>(stride_ - 1)) change_to(stride_ - 1);
}

void TickPace::change_to(long stride) {
  stride_ = stride;
  since_change_ = 0;
}

}  // namespace palpate::loop
