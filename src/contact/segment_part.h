#pragma once
#include <algorithm>

namespace palpate::contact {

/// Part [s0, s1] of a segment; empty where s0 > s1.
struct Part {
  double s0 = 0.0, s1 = 1.0;
  /// Cut to where low <= a + s d <= high.
  void cut(double a, double d, double low, double high) {
    if (d == 0.0) {
      if (a < low || a > high) s1 = -1.0;
      return;
    }
    const double one = (low - a) / d, two = (high - a) / d;
    s0 = std::max(s0, std::min(one, two));
    s1 = std::min(s1, std::max(one, two));
  }
};

}  // namespace palpate::contact
