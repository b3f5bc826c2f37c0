#pragma once
#include <algorithm>
#include <cmath>

namespace palpate::contact {

/// Returns the time in which skin at a gap that changes at the given rate penetrates by half of a thickness,
/// measured from first touch or, if it touches already, from its present position [s]. Beyond the middle the
/// shortest way out is through the other side.
inline double time_to_middle(double gap, double rate, double thickness) {
  return rate < 0.0 ? (std::max(gap, 0.0) + 0.5 * thickness) / -rate : HUGE_VAL;
}

}  // namespace palpate::contact
