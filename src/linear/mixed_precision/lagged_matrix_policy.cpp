#include "linear/mixed_precision/lagged_matrix_policy.h"

#include <algorithm>

namespace palpate::linear {

bool LaggedMatrixPolicy::serves() {
  since_seen_ = std::min(since_seen_ + 1, kForgotten);
  if (since_seen_ < kForgotten && !small_enough(age_ + 1, size_)) return false;
  ++age_;
  return true;
}

bool LaggedMatrixPolicy::sure(double correction) const {
  return since_seen_ < kTrusted && correction <= kSameSize * seen_size_ && small_enough(age_, correction);
}

void LaggedMatrixPolicy::seen(double error, double correction) {
  if (age_ == 0 || !(correction > 0.0)) return;
  const bool again = since_seen_ == 0;  // checked before in the same step
  rate_ = std::max(again ? rate_ : 0.0, error / (correction * age_));
  seen_size_ = std::max(again ? seen_size_ : 0.0, correction);
  since_seen_ = 0;
}

void LaggedMatrixPolicy::failed() {
  rate_ = std::max(rate_, kSlow);
  since_seen_ = 0;
}

}  // namespace palpate::linear
