#pragma once
#include <algorithm>
#include <cmath>

namespace palpate::contact {

/// How long skin at a gap, which changes at the given rate, takes to go half of a thickness farther than
/// where it touches, or than where it is when it has touched already [s].  Beyond the middle the nearest way
/// out is through the other side.
inline double time_to_middle(double gap, double rate, double thickness) {
  return rate < 0.0 ? (std::max(gap, 0.0) + 0.5 * thickness) / -rate : HUGE_VAL;
}

}  // namespace palpate::contact
