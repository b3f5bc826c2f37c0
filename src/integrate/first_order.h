#pragma once
#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

namespace palpate::integrate {

/// The system as y' = F(t, y), y = [q; u], for integrators that know vectors only.
/// Driven directions keep their places in y with y' = 0 and are never read: before every evaluation the System writes
/// their exact values into a copy.  So a drive costs no accuracy and no step, and its jumps stay outside the history.
class FirstOrder {
 public:
  FirstOrder(dynamics::System& system, dynamics::State& state) : system_(system), state_(state) {}
  int size() const { return state_.layout().q_size + state_.layout().u_size; }
  const dynamics::Layout& layout() const { return state_.layout(); }

  /// Sees y with the driven directions at their values for time t; valid until the next call.
  dynamics::StateView view(double t, const double* y);
  /// y' = [N(q) u; M^-1 f].  False when an entry is not finite.
  bool derivative(double t, const double* y, double* y_dot, dynamics::StepperCounters& counters);
  /// y = [q; u] of the State.
  void load(double* y) const;
  /// The State becomes y at time t, on the manifold, driven directions exact.
  void store(double t, const double* y);
  /// The same into vectors of the caller.
  void finish(double t, const double* y, VecX& q, VecX& u) const;

 private:
  dynamics::System& system_;
  dynamics::State& state_;
  VecX imposed_, force_, acceleration_;
};

}  // namespace palpate::integrate
