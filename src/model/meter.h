#pragma once
#include <cstddef>
#include <functional>

#include "palpate/core/types.h"
#include "palpate/model/limits.h"
#include "palpate/model/progress.h"

namespace palpate::model {

/// Watches the time that refinement takes, and reports its progress.  The criteria of the mesher call it for
/// each element that they judge, in the mesher's own thread; an Error that it throws unwinds the mesher.
class Meter {
 public:
  /// @param place  is called with the place of the work at each look; may be empty
  explicit Meter(const Limits& limits, std::function<void(const Vec3&)> place = {});

  /// A refinement that should make about so many points, and reports fractions of itself.
  void begin(double expected_points, Progress progress);
  /// @param points  vertices so far; 0: not known  @param place  of the element that is judged [m]
  /// @throws Error when the time is over
  void judged(std::size_t points, const Vec3& place) {
    if (++calls_ % kBetweenLooks == 0) look(points, place);
  }
  /// @throws Error when the time is over; `what` was being done
  void check(const char* what) const;
  double seconds_left() const;  ///< at least a millisecond: zero means "no limit" to CGAL
  int points() const { return limits_.points; }

 private:
  static constexpr unsigned kBetweenLooks = 256;
  void look(std::size_t points, const Vec3& place);

  Limits limits_;
  std::function<void(const Vec3&)> place_;
  Progress progress_;
  double start_, expected_ = 1.0, reported_ = 0.0;
  unsigned calls_ = 0;
};

}  // namespace palpate::model
