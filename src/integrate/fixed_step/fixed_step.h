#pragma once
#include <string>

#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

namespace palpate::integrate {

/// Common base of the hand-written steppers; a derived method defines one step.
///
/// Steps. The interval to t_end is divided into the fewest equal steps that are no longer than step_s. Their
/// number is the same as if only the last one were shortened, with a smaller error and no very short step.
/// Where all intervals are equal (exchange periods), so are all steps, and a kept factor, the ratio in a
/// two-step formula and the acceleration of generalized-alpha remain valid.
///
/// Failure. Failures that a method declares recoverable (Newton did not converge, an intermediate value is
/// not finite) are retried with halves, quarters, ... of that one step, down to 1/64: where a nonlinear solve
/// fails, the step is too long for its convergence, and a user who chose h = 10 ms expects the other steps
/// unchanged. Each failed attempt counts as rejected, each step that was divided as halved. Other failures
/// end advance_to at once, with the method's name, the reason, time and step; the State holds the last
/// successful step, which is always finite.
///
/// Dense output. Between the ends of the last step: for methods of order 1 q and u are linear; for order 2 q
/// is the cubic through q and q' = N u at both ends, and u is its rate; for order 4 u is also the cubic
/// through u and u' at both ends. Driven directions are exact.
class FixedStep : public dynamics::Stepper {
 public:
  std::string name() const final { return name_; }
  dynamics::StepResult advance_to(double t_end) final;
  void prepare(double interval) final;
  bool dense_output(double t, VecX& q, VecX& u) const final;
  void reinit(dynamics::ReinitReason reason) final;
  bool follow(dynamics::StepFollower* follower) final {
    follower_ = follower;
    return true;
  }
  const dynamics::StepperCounters& counters() const final;

 protected:
  /// Interpolant of the dense output.
  enum class Between { kLinear, kCubic, kCubicWithAcceleration };

  /// Outcome of one attempt at a step.
  struct Attempt {
    dynamics::StepStatus status = dynamics::StepStatus::kOk;
    int iterations = 0;        ///< Newton iterations.
    double residual = 0.0;     ///< Newton's last correction, where 1 is its tolerance.
    const char* what = "";     ///< Reason of a failure, in words.
    bool recoverable = false;  ///< A shorter step may succeed.
  };

  FixedStep(std::string name, int order, Between between, dynamics::System& system, dynamics::State& state,
            const IntegratorSpec& spec);

  /// Attempts the step from the State to t1 = its time + h; the new q and u are written to q1_ and u1_. Must
  /// not change anything that a later, shorter attempt reads.
  virtual Attempt attempt(double h, double t1) = 0;
  /// Called after the attempt became the State, to update the method's history.
  virtual void accepted(double /*h*/) {}
  /// Discards history and factors.
  virtual void forget(dynamics::ReinitReason reason) = 0;
  /// Adds the counts of a method's solvers.
  virtual void collect(dynamics::StepperCounters&) const {}

  /// Computes a = u' at (t, q, u); returns false when it is not finite.
  bool acceleration(double t, const double* q, const double* u, VecX& a);
  const dynamics::Layout& layout() const { return state_.layout(); }
  dynamics::StateView now() const { return static_cast<const dynamics::State&>(state_).view(); }

  dynamics::System& system_;
  dynamics::State& state_;
  IntegratorSpec spec_;
  mutable dynamics::StepperCounters counters_;
  VecX q1_, u1_;  ///< End of the attempted step.
  VecX a0_, a1_;  ///< u' at both ends of the last step, for kCubicWithAcceleration.

 private:
  double steps_in(double interval) const;
  dynamics::StepResult cover(double t1, double h, double t_end);
  void accept(double h, double t1);
  void tell(const Attempt& attempt, double h, double t1, int halvings) const;
  dynamics::StepResult failure(dynamics::StepStatus status, double h, int iterations,
                               const std::string& what) const;

  std::string name_;
  int order_;
  long clamped_before_;
  Between between_;
  int taken_ = 0;  ///< Steps since the last output.
  VecX q0_, u0_;   ///< Start of the last step.
  dynamics::StepFollower* follower_ = nullptr;
  double t0_ = 0.0, t1_ = 0.0;  ///< Ends of the last step; equal: there is no interpolant.
  mutable VecX rate_, rate1_;
};

}  // namespace palpate::integrate
