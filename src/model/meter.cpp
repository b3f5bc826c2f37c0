#include "meter.h"

#include <algorithm>

#include "core/clock.h"
#include "palpate/core/error.h"

namespace palpate::model {

Meter::Meter(const Limits& limits, std::function<void(const Vec3&)> place)
    : limits_(limits), place_(std::move(place)), start_(wall_seconds() - limits.spent) {}

void Meter::begin(double expected_points, Progress progress) {
  progress_ = std::move(progress);
  expected_ = std::max(expected_points, 1.0);
  reported_ = 0.0;
}

double Meter::seconds_left() const { return std::max(limits_.seconds - (wall_seconds() - start_), 1e-3); }

void Meter::check(const char* what) const {
  if (wall_seconds() - start_ < limits_.seconds) return;
  fail(
      "the surface was not filled with tetrahedra within {:.3g} s: the time ran out {}; raise --limit-s, or "
      "reduce --tetrahedra",
      limits_.seconds, what);
}

void Meter::look(std::size_t points, const Vec3& place) {
  if (place_) place_(place);
  if (wall_seconds() - start_ >= limits_.seconds)
    fail(
        "the surface was not filled with tetrahedra within {:.3g} s: refinement was at ({:.4g}, {:.4g}, "
        "{:.4g}) m, with {} points; raise --limit-s, reduce --tetrahedra, or smooth the surface there",
        limits_.seconds, place.x(), place.y(), place.z(), points);
  if (!progress_) return;
  // The first half when all estimated points are present, the rest for points beyond the estimate; progress
  // never decreases when refinement restarts.
  const double done = static_cast<double>(points) / expected_;
  reported_ = std::max(reported_, done / (1.0 + done));
  progress_(reported_);
}

}  // namespace palpate::model
