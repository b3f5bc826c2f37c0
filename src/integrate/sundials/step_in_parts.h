#pragma once
#include "integrate/sundials/hidden.h"
#include "integrate/tuning.h"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// Length of the next fixed step. After a failed nonlinear solve the rest of that one step is divided into
/// halves, quarters, ... down to 1/64, as in the hand-written steppers (fixed_step/fixed_step.h): a user who
/// chose h expects the other steps unchanged.
class StepInParts {
 public:
  explicit StepInParts(double step) : step_(step) {}

  bool halved() const { return halvings_ > 0; }
  int halvings() const { return halvings_; }  ///< The step of next() is 1/2^halvings() of a whole one.
  void begin() { halvings_ = 0; }             ///< Starts a new interval; discards parts of an earlier step.
  /// Returns the length of the next step from t towards t_end. A length above one step by rounding is taken
  /// as one step, so that no step is as short as that rounding.
  double next(double t, double t_end) {
    if (halvings_ > 0 && t >= whole_end_ - tuning::kRoundingOfStep * step_) halvings_ = 0;
    const double end = halvings_ > 0 ? whole_end_ : t_end, requested = halvings_ > 0 ? part_ : step_;
    length_ = end - t <= requested * (1.0 + tuning::kRoundingOfStep) ? end - t : requested;
    return length_;
  }
  /// Shortens the step of next() from t after a failure; returns false where it was the shortest.
  bool shorten(double t) {
    if (halvings_ == 0) whole_end_ = t + length_;
    if (halvings_ == tuning::kHalvings) return false;
    part_ = 0.5 * (halvings_ == 0 ? length_ : part_);
    ++halvings_;
    return true;
  }

 private:
  double step_, length_ = 0.0, part_ = 0.0, whole_end_ = 0.0;
  int halvings_ = 0;
};

}  // namespace sun
}  // namespace palpate::integrate
