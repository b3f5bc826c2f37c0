#pragma once
#include <string>

#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

namespace palpate::integrate {

/// What the hand-written steppers share; a method says what one step is and nothing else.
///
/// Steps.  The interval to t_end is cut into the fewest equal steps that are no longer than step_s.  As many
/// as if only the last one were shortened, with a smaller error, and no sliver of a step: where all intervals
/// are alike (exchange periods), so are all steps, and a kept factor, the ratio in a two-step formula and the
/// acceleration of generalized-alpha stay what they are.
///
/// Failure.  What a method calls recoverable (Newton did not converge, a value that is not finite on the way)
/// is tried again in halves, quarters, ... of that one step, down to 1/64: where a nonlinear solve fails, it
/// is the step that is too long for its convergence, and a user who chose h = 10 ms wants the other steps as
/// they are.  Each failed attempt counts as rejected, each step that was taken in parts as halved.  What is
/// not recoverable ends advance_to at once, with the method's name, the reason, time and step; the State
/// holds the last good step, always finite.
///
/// Dense output.  Between the ends of the last step: of order 1 methods q and u are linear; of order 2, q is
/// the cubic through both ends' q and q' = N u, and u is its rate; of order 4, u too is the cubic through
/// both ends' u and u'.  Driven directions are exact.
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
  enum class Between { kLinear, kCubic, kCubicWithAcceleration };

  /// Outcome of one attempt at a step.
  struct Attempt {
    dynamics::StepStatus status = dynamics::StepStatus::kOk;
    int iterations = 0;        ///< of Newton
    double residual = 0.0;     ///< Newton's last correction, 1 is its tolerance
    const char* what = "";     ///< on failure, in words
    bool recoverable = false;  ///< a shorter step may succeed
  };

  FixedStep(std::string name, int order, Between between, dynamics::System& system, dynamics::State& state,
            const IntegratorSpec& spec);

  /// The step from the State to t1 = its time + h: the new q and u go to q1_ and u1_.  Changes nothing that a
  /// later, shorter attempt reads.
  virtual Attempt attempt(double h, double t1) = 0;
  /// The attempt became the State: keep its history.
  virtual void accepted(double /*h*/) {}
  /// Forget history and factors.
  virtual void forget(dynamics::ReinitReason reason) = 0;
  virtual void collect(dynamics::StepperCounters&) const {}

  /// a = u' at (t, q, u); false when it is not finite.
  bool acceleration(double t, const double* q, const double* u, VecX& a);
  const dynamics::Layout& layout() const { return state_.layout(); }
  dynamics::StateView now() const { return static_cast<const dynamics::State&>(state_).view(); }

  dynamics::System& system_;
  dynamics::State& state_;
  IntegratorSpec spec_;
  mutable dynamics::StepperCounters counters_;
  VecX q1_, u1_;  ///< end of the attempted step
  VecX a0_, a1_;  ///< u' at both ends of the last step, for kCubicWithAcceleration

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
  int taken_ = 0;  ///< steps since the last output
  VecX q0_, u0_;   ///< start of the last step
  dynamics::StepFollower* follower_ = nullptr;
  double t0_ = 0.0, t1_ = 0.0;  ///< the last step; equal: none to interpolate in
  mutable VecX rate_, rate1_;
};

}  // namespace palpate::integrate
