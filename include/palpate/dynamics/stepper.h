#pragma once
#include <algorithm>
#include <atomic>
#include <memory>
#include <string>

#include "palpate/core/registry.h"
#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/spec.h"
#include "palpate/dynamics/state.h"

namespace palpate::dynamics {

class System;

/// How a call of a stepper ended.
enum class StepStatus {
  kOk,
  kNewtonFailed,     ///< Newton's method did not converge at the smallest step
  kErrorTestFailed,  ///< no step that the method takes keeps the tolerance
  kSolverFailed,     ///< the linear solver gave no answer
  kNotFinite,        ///< a force, a position or a velocity is NaN or infinite
  kTooManySteps,     ///< IntegratorSpec::max_steps were not enough
  kBadSettings,      ///< the method cannot run with these settings
  kInterrupted       ///< the flag of set_interrupt() was set
};
/// In words, for messages: "ok", "Newton did not converge".
const char* to_string(StepStatus status);

/// Numerical outcomes are data: the loop decides what to do with them.
struct StepResult {
  StepStatus status = StepStatus::kOk;  ///< why it ended
  double t = 0.0;                       ///< time reached [s]
  double h = 0.0;                       ///< last step [s]
  int order = 0;                        ///< order used in it
  int iterations = 0;                   ///< Newton iterations in it
  double residual = 0.0;                ///< of the nonlinear solve, in the method's norm
  std::string message;                  ///< on failure: the library's flag name, time and step
  /// Whether it got where it should.
  bool ok() const { return status == StepStatus::kOk; }
};

/// Why a stepper is told to start anew: what happened to the system or its state.
enum class ReinitReason { kContactRefreshed, kStateChanged, kLayoutChanged, kParametersChanged };

/// What a stepper did since it was made.
struct StepperCounters {
  long steps = 0, rejected = 0;                     ///< accepted; attempted and refused
  long error_test_failures = 0;                     ///< steps that the error test refused
  long newton_failures = 0, newton_iterations = 0;  ///< solves that failed; iterations of all
  long force_evaluations = 0;                       ///< of the whole right-hand side
  long tangent_evaluations = 0;                     ///< of step matrices
  long reinits = 0;                                 ///< calls of reinit()
  long events = 0;                                  ///< roots that a step was cut short at
  /// matrices with no Cholesky factor, or of negative curvature: definite tangents (projected); the rest: LU
  long indefinite = 0;
  long projected = 0;  ///< of those, answered by definite tangents
  /// equilibria whose residual is the rounding of forces that cancel, above the tolerance asked for
  long rounding_limited = 0;
  long unconverged = 0;  ///< solves that an iterative linear solver gave up, for a factor to answer
  long lu = 0;           ///< matrices that were left to LU
  /// Newton's iterations by the matrix of an earlier solve: an earlier stage, step or, of SUNDIALS, step size
  long kept_matrix_iterations = 0;
  /// nonlinear solves of fixed steps that failed and were tried again: with definite tangents; and then by
  /// corrections taken whole whatever they do to the residual
  long definite_retries = 0, leaps = 0;
  /// fixed steps (of statics: load steps) that failed and were taken in parts, and the parts
  long halved_steps = 0, step_parts = 0;
  long downhill = 0;    ///< of statics: proximal steps, towards less energy, where Newton's method failed
  long clamped = 0;     ///< tangents of elements that were bounded near a singularity of their law
  long fast_steps = 0;  ///< of the fast side of a multi-rate method
  /// The smallest part of a fixed step was 1/2^most_halvings of it.  The largest of all: no sum, not visited.
  long most_halvings = 0;
  double force_s = 0.0, tangent_s = 0.0;  ///< wall time [s]
  SolverCounters solver;                  ///< of its linear solver
};

/// As of SolverCounters (linear_solver.h), which it visits too.
template <class F, class... Counters>
requires(std::same_as<std::remove_const_t<Counters>, StepperCounters>&&...) constexpr void visit_counters(
    F&& f, Counters&... c) {
  f("steps", c.steps...);
  f("rejected_steps", c.rejected...);
  f("error_test_failures", c.error_test_failures...);
  f("newton_failures", c.newton_failures...);
  f("newton_iterations", c.newton_iterations...);
  f("force_evaluations", c.force_evaluations...);
  f("tangent_evaluations", c.tangent_evaluations...);
  f("reinitialisations", c.reinits...);
  f("events", c.events...);
  f("indefinite_matrices", c.indefinite...);
  f("projected_matrices", c.projected...);
  f("unconverged_linear_solves", c.unconverged...);
  f("rounding_limited_equilibria", c.rounding_limited...);
  f("lu_matrices", c.lu...);
  f("kept_matrix_iterations", c.kept_matrix_iterations...);
  f("definite_tangent_retries", c.definite_retries...);
  f("leaping_retries", c.leaps...);
  f("halved_steps", c.halved_steps...);
  f("step_parts", c.step_parts...);
  f("downhill_steps", c.downhill...);
  f("clamped_tangents", c.clamped...);
  f("fast_steps", c.fast_steps...);
  f("force_s", c.force_s...);
  f("tangent_s", c.tangent_s...);
  visit_counters(f, c.solver...);
}
static_assert(bytes_of_counters<StepperCounters>() - bytes_of_counters<SolverCounters>() +
                      sizeof(SolverCounters) + sizeof(StepperCounters::most_halvings) ==
                  sizeof(StepperCounters),
              "visit_counters() leaves out a member of StepperCounters");

/// What was counted between two samples at one stepper's counters.
inline StepperCounters operator-(StepperCounters later, const StepperCounters& earlier) {
  visit_counters([](const char*, auto& value, const auto& before) { value -= before; }, later, earlier);
  return later;
}

/// What two steppers counted together, one after the other.
inline StepperCounters operator+(const StepperCounters& earlier, StepperCounters later) {
  visit_counters([](const char*, auto& value, const auto& before) { value += before; }, later, earlier);
  later.most_halvings = std::max(later.most_halvings, earlier.most_halvings);
  if (later.solver.ordering.empty()) later.solver.ordering = earlier.solver.ordering;
  return later;
}

/// One attempted step, accepted or not: what `--trace` keeps.
struct StepAttempt {
  /// kEvent: cut short at a root, then restarted
  enum class Outcome { kAccepted, kErrorTest, kNewton, kNotFinite, kEvent };
  double t = 0.0;  ///< start of the step [s]
  double h = 0.0;  ///< its length [s]
  int order = 0;   ///< of the method
  /// estimate in the method's weighted norm, 1 is the tolerance; NaN where the method has none
  double error = 0.0;
  int newton_iterations = 0;             ///< in this attempt
  Outcome outcome = Outcome::kAccepted;  ///< what became of it
  /// entry of u (a node's axis, a rigid body's direction) with the largest share of the error; -1: unknown
  int worst_dof = -1;
  /// the most inverted element at the attempted state, over the terms in their order; -1: none
  int inverted_element = -1;
  std::string inverted_in;  ///< the term that it belongs to
  /// of a fixed step that is taken in parts: this is 1/2^halvings of it; 0: whole
  int halvings = 0;
};
/// As traces call it.
const char* to_string(StepAttempt::Outcome outcome);

/// Sees every attempted step.
class StepTrace {
 public:
  virtual ~StepTrace() = default;
  /// After each attempted step.
  virtual void attempt(const StepAttempt& attempt) = 0;
};

class Stepper;

/// Called after every accepted step while its interpolant is valid: dense_output then answers for times in
/// [t0, t1], and the State is at t1. What a loop needs that wants the solution at more times than it lands
/// on.
class StepFollower {
 public:
  virtual ~StepFollower() = default;
  /// After each accepted step from t0 to t1 [s]; the stepper's dense output covers it.
  virtual void stepped(const Stepper& stepper, double t0, double t1) = 0;
};

/// Advances a System's State in time.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// As scenes call it.
  virtual std::string name() const = 0;
  /// Steps until exactly t_end (> state time); on success the State's time is t_end.  On failure the State
  /// holds the last good step.
  virtual StepResult advance_to(double t_end) = 0;
  /// Does what the first step would do for all others, analyses and memory, where somebody waits for that
  /// step. The State stays as it is, and so do later results, to within the tolerance of a linear solver that
  /// learns from its solutions.
  /// It is given the interval that advance_to() will be asked for [s].
  virtual void prepare(double /*interval*/) {}
  /// q and u at a time within the last step (or between the last two outputs), by the method's own
  /// interpolant.  False where t is outside.
  virtual bool dense_output(double t, VecX& q, VecX& u) const = 0;
  /// The right-hand side or the State was changed from outside: forget history.
  virtual void reinit(ReinitReason reason) = 0;
  /// Of its whole life.
  virtual const StepperCounters& counters() const = 0;

  /// Tells a trace of every attempted step from now on; null for none.  What a step costs without a trace
  /// does not change.
  void set_trace(StepTrace* trace) { trace_ = trace; }
  /// Tells a follower of every accepted step from now on; null for none.  False where the method does not:
  /// what is wanted must then be landed on.
  virtual bool follow(StepFollower*) { return false; }
  /// Where a flag is given and becomes true, advance_to ends after the current step with kInterrupted and the
  /// last good state.
  void set_interrupt(const std::atomic<bool>* flag) { interrupt_ = flag; }

 protected:
  /// Null where nobody wants a trace.
  StepTrace* trace() const { return trace_; }
  /// Whether the flag of set_interrupt() is set.
  bool interrupted() const { return interrupt_ && interrupt_->load(std::memory_order_relaxed); }

 private:
  StepTrace* trace_ = nullptr;
  const std::atomic<bool>* interrupt_ = nullptr;
};

/// What theory says of a method: read by the conformance suite, the stability matrix, reports and `palpate
/// list`.
enum class StepControl { kAdaptive, kFixed, kEither };  ///< rtol; step_s; either, by fixed_step
/// How a method answers stiff, stable problems.
enum class Stability {
  kExplicit,  ///< stable up to a step that the largest frequency bounds
  kStatic,    ///< no dynamics: equilibria
  kAlpha,     ///< A(alpha)-stable: a sector of the left half plane (BDF 3 to 5)
  kA,         ///< A-stable: every stable linear problem decays, at any step
  kL,         ///< A-stable, and stiff modes vanish at once
};
/// In words, as `palpate list integrators` prints it.
const char* to_string(Stability stability);

/// What theory says of one method.
struct StepperTraits {
  /// "BDF", "DIRK", "explicit Runge-Kutta": references are checked across families
  std::string family;
  int order = 1;  ///< of a smooth, non-stiff problem; of a variable-order method the highest
  /// of a stiff, strongly damped mode that the step does not resolve (order reduction); 0: unstable there
  int stiff_order = 1;
  StepControl control = StepControl::kFixed;   ///< how its steps are chosen
  Stability stability = Stability::kExplicit;  ///< see there
  bool implicit = false;                       ///< asks for tangents and a linear solver
  bool multistep = false;                      ///< forgets its history at every re-initialisation
  /// of the system, in words: "force", "force, tangent", "tool or contact as the fast part"
  std::string needs;
  /// where the spec names none: "auto" where a matrix serves a solve or two, as those did that it chooses by;
  /// a kept factor serves many
  std::string linear_solver = "cholmod";
  /// one linear solve a step, no iteration: an approximate tangent is a choice of the method, and costs no
  /// convergence
  bool linearised = false;
};

/// Makes a stepper of a system at a state; both outlive it.
using MakeStepper = std::unique_ptr<Stepper> (*)(System&, State&, const IntegratorSpec&,
                                                 std::unique_ptr<LinearSolver>);
/// One integrator of the registry.
struct StepperEntry {
  std::string name;                ///< as scenes call it
  std::string summary;             ///< one line
  StepperTraits traits;            ///< what theory says of it
  MakeStepper make;                ///< of an explicit method the linear solver is null
  std::vector<PartKey> keys = {};  ///< of [integrator] that the method uses
  /// The relative tolerance that the method's own error test holds a step to, so that the error over a given
  /// time falls in proportion to spec.rtol.  Null for methods without an error test; of those that can do
  /// both it means nothing with fixed_step.
  double (*error_test_rtol)(const IntegratorSpec& spec) = nullptr;
  /// The smallest rtol that the method takes with this spec: what it would make of less is rounding.  Null
  /// where error_test_rtol is.
  double (*tightest_rtol)(const IntegratorSpec& spec) = nullptr;
};
/// All integrators.
using StepperRegistry = std::vector<StepperEntry>;

}  // namespace palpate::dynamics
