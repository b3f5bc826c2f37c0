#pragma once
#include <algorithm>
#include <limits>

namespace palpate::contact {

/// Part [s0, s1] of a segment, or of a line; empty where s0 > s1.
struct Part {
  double s0 = 0.0, s1 = 1.0;
  static Part line() {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    return {-kFar, kFar};
  }
  void clear() { s0 = 1.0, s1 = -1.0; }
  /// Returns the last parameter, -infinity for an empty part.
  double end() const { return s0 <= s1 ? s1 : -std::numeric_limits<double>::infinity(); }
  /// Clips the part to low <= a + s d <= high.
  void cut(double a, double d, double low, double high) {
    if (d == 0.0) {
      if (a < low || a > high) clear();
      return;
    }
    const double one = (low - a) / d, two = (high - a) / d;
    s0 = std::max(s0, std::min(one, two));
    s1 = std::min(s1, std::max(one, two));
  }
};

}  // namespace palpate::contact
