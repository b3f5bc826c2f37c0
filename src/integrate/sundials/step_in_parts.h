#pragma once
#include "integrate/sundials/hidden.h"
#include "integrate/tuning.h"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// The length of the next fixed step: whole, or where a nonlinear solve failed, the rest of that one step
/// in halves, quarters, ... down to 1/64, as the hand-written steppers take it (fixed_step/fixed_step.h): a
/// user who chose h wants the other steps as they are.
class StepInParts {
 public:
  explicit StepInParts(double step) : step_(step) {}

  bool halved() const { return halvings_ > 0; }
  int halvings() const { return halvings_; }  ///< the step of next() is 1/2^halvings() of a whole one
  void begin() { halvings_ = 0; }             ///< nothing is left of an earlier step
  /// From t towards t_end.  What is longer than a step by rounding is one, and a step shorter than rounding
  /// of the others is none.
  double next(double t, double t_end) {
    if (halvings_ > 0 && t >= whole_end_ - tuning::kRoundingOfStep * step_) halvings_ = 0;
    const double end = halvings_ > 0 ? whole_end_ : t_end, wanted = halvings_ > 0 ? part_ : step_;
    length_ = end - t <= wanted * (1.0 + tuning::kRoundingOfStep) ? end - t : wanted;
    return length_;
  }
  /// The step of next() from t has failed: a shorter one; false where it was short enough.
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
