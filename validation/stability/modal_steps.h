#pragma once
#include "column.h"

namespace palpate::stability {

/// One oscillator a'' + 2 z w a' + w^2 a = 0 under a method at fixed steps H, from the method's formula
/// alone: the method is not run.  In x = [w a; a'] the energy is |x|^2/2, and with y = w H the step depends
/// on y and z only.  A method that carries more than x along (an acceleration, the last step) has it behind
/// x.
class ModalSteps {
 public:
  /// @param contact_share  of the force, that additive methods take explicitly and multi-rate ones fast
  /// @throws Error where the method has no formula here
  ModalSteps(const Column& column, double y, double z, double contact_share = 0.0);

  VecX start(const Eigen::Vector2d& x) const { return start_ * x; }
  /// The state after the first step from start(), and after each further one.
  const MatX& first() const { return first_; }
  const MatX& next() const { return next_; }
  double spectral_radius() const;
  /// Largest factor by which one step from start() can multiply the amplitude |x|.
  double norm_of_first() const;

 private:
  void one_step(const MatX& step);
  void bdf2(const MatX& Z);
  void generalized_alpha(double y, double z, double r);
  MatX start_, first_, next_;
};

/// All fixed-step columns but statics.
bool has_modal_steps(const Column& column);

}  // namespace palpate::stability
