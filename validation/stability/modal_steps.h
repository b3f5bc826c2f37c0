#pragma once
#include "column.h"

namespace palpate::stability {

/// One oscillator a'' + 2 z w a' + w^2 a = 0 under a method at fixed steps H, from the method's formula
/// alone: the method is not run. In x = [w a; a'] the energy is |x|^2/2, and with y = w H the step depends
/// only on y and z. A method with more variables than x (an acceleration, the last step) has them after x.
class ModalSteps {
 public:
  /// @param contact_share fraction of the force that additive methods treat explicitly and multi-rate methods
  /// fast
  /// @throws Error if the method has no formula here
  ModalSteps(const Column& column, double y, double z, double contact_share = 0.0);

  VecX start(const Eigen::Vector2d& x) const { return start_ * x; }
  /// Propagation of the state from start() over the first step, and over each further step.
  const MatX& first() const { return first_; }
  const MatX& next() const { return next_; }
  double spectral_radius() const;
  /// Returns the largest factor by which one step from start() can multiply the amplitude |x|.
  double norm_of_first() const;

 private:
  void one_step(const MatX& step);
  void bdf2(const MatX& Z);
  void generalized_alpha(double y, double z, double r);
  MatX start_, first_, next_;
};

/// Returns whether the formula exists: all fixed-step columns but statics.
bool has_modal_steps(const Column& column);

}  // namespace palpate::stability
