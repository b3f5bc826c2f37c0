#pragma once
#include <cstddef>
#include <functional>

#include "model/limits.h"
#include "model/progress.h"
#include "palpate/core/types.h"

namespace palpate::model {

/// Limits the time of refinement and reports its progress.  The mesher's criteria call it for each element
/// that they judge, in the mesher's thread; an Error that it throws unwinds the mesher.
class Meter {
 public:
  /// @param place  receives the place of the work at each check; may be empty
  explicit Meter(const Limits& limits, std::function<void(const Vec3&)> place = {});

  /// Starts a refinement with an estimated number of points, which reports fractions of itself.
  void begin(double expected_points, Progress progress);
  /// Counts one element that a criterion judges; every 256th call checks the time and reports progress.
  /// @param points  vertices so far; 0: unknown
  /// @param place   position of the element [m]
  /// @throws Error when the time is over
  void judged(std::size_t points, const Vec3& place) {
    if (++calls_ % kBetweenLooks == 0) look(points, place);
  }
  /// @param what  the current activity, for the message
  /// @throws Error when the time is over
  void check(const char* what) const;
  double seconds_left() const;  ///< at least a millisecond, because zero means "no limit" to CGAL
  int points() const { return limits_.points; }

 private:
  static constexpr unsigned kBetweenLooks = 256;
  /// Checks the time and reports progress.
  void look(std::size_t points, const Vec3& place);

  Limits limits_;
  std::function<void(const Vec3&)> place_;
  Progress progress_;
  double start_, expected_ = 1.0, reported_ = 0.0;
  unsigned calls_ = 0;
};

}  // namespace palpate::model
