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

/// Outcome of a call of a stepper.
enum class StepStatus {
  kOk,
  kNewtonFailed,     ///< Newton's method did not converge at the smallest step.
  kErrorTestFailed,  ///< The error test failed at every step size that the method tried.
  kSolverFailed,     ///< The linear solver failed.
  kNotFinite,        ///< A force, a position or a velocity is NaN or infinite.
  kTooManySteps,     ///< IntegratorSpec::max_steps was reached.
  kBadSettings,      ///< The method cannot run with these settings.
  kInterrupted       ///< The flag of set_interrupt() was set.
};
/// Returns the status in words, for messages: "ok", "Newton did not converge".
const char* to_string(StepStatus status);

/// Result of a call of a stepper. Numerical outcomes are data, not exceptions: the loop decides how to
/// proceed.
struct StepResult {
  StepStatus status = StepStatus::kOk;  ///< Reason of the return.
  double t = 0.0;                       ///< Time reached [s].
  double h = 0.0;                       ///< Last step [s].
  int order = 0;                        ///< Order of the last step.
  int iterations = 0;                   ///< Newton iterations in the last step.
  double residual = 0.0;                ///< Residual of the nonlinear solve, in the method's norm.
  std::string message;                  ///< On failure: the library's flag name, time and step.
  /// Returns whether the requested time was reached.
  bool ok() const { return status == StepStatus::kOk; }
};

/// Reason of a re-initialisation: change of the system or of its state.
enum class ReinitReason { kContactRefreshed, kStateChanged, kLayoutChanged, kParametersChanged };

/// Work done by a stepper since it was made.
struct StepperCounters {
  long steps = 0, rejected = 0;                     ///< Accepted steps; attempted steps that were rejected.
  long error_test_failures = 0;                     ///< Steps rejected by the error test.
  long newton_failures = 0, newton_iterations = 0;  ///< Nonlinear solves that failed; iterations of all.
  long force_evaluations = 0;                       ///< Evaluations of the whole right-hand side.
  long tangent_evaluations = 0;                     ///< Assemblies of step matrices.
  long reinits = 0;                                 ///< Calls of reinit().
  long events = 0;                                  ///< Steps shortened to a root.
  /// Matrices without a Cholesky factor, or of negative curvature; handled by definite tangents
  /// (`projected`), otherwise by LU.
  long indefinite = 0;
  long projected = 0;  ///< Indefinite matrices handled by definite tangents.
  /// Equilibria whose residual is the rounding of cancelling forces, above the requested tolerance.
  long rounding_limited = 0;
  /// Solves in which an iterative linear solver did not converge and a factorisation was used.
  long unconverged = 0;
  long lu = 0;  ///< Matrices factored by LU.
  /// Newton iterations with the matrix of an earlier solve: an earlier stage or step, or in SUNDIALS another
  /// step size.
  long kept_matrix_iterations = 0;
  /// Nonlinear solves of fixed steps that failed and were repeated: with definite tangents; and then by
  /// undamped corrections, whatever their effect on the residual.
  long definite_retries = 0, leaps = 0;
  /// Fixed steps (in statics: load steps) that failed and were divided into parts, and the number of parts.
  long halved_steps = 0, step_parts = 0;
  /// Statics: proximal steps, which decrease the energy, taken where Newton's method failed.
  long downhill = 0;
  long clamped = 0;     ///< Tangents of elements that were bounded near a singularity of their law.
  long fast_steps = 0;  ///< Steps of the fast side of a multi-rate method.
  /// The smallest part of a fixed step was 1/2^most_halvings of it. A maximum, not a sum, and therefore not
  /// visited.
  long most_halvings = 0;
  double force_s = 0.0, tangent_s = 0.0;  ///< Wall time [s].
  SolverCounters solver;                  ///< Counters of its linear solver.
};

/// Calls f(name, members...) for every number of these counters and of their SolverCounters (see
/// linear_solver.h).
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

/// Returns the counts between two samples of one stepper's counters.
inline StepperCounters operator-(StepperCounters later, const StepperCounters& earlier) {
  visit_counters([](const char*, auto& value, const auto& before) { value -= before; }, later, earlier);
  return later;
}

/// Returns the sum of the counts of two steppers that ran one after the other.
inline StepperCounters operator+(const StepperCounters& earlier, StepperCounters later) {
  visit_counters([](const char*, auto& value, const auto& before) { value += before; }, later, earlier);
  later.most_halvings = std::max(later.most_halvings, earlier.most_halvings);
  if (later.solver.ordering.empty()) later.solver.ordering = earlier.solver.ordering;
  return later;
}

/// Record of one attempted step, accepted or not, as written by `--trace`.
struct StepAttempt {
  /// kEvent: shortened to a root, then restarted.
  enum class Outcome { kAccepted, kErrorTest, kNewton, kNotFinite, kEvent };
  double t = 0.0;  ///< Start of the step [s].
  double h = 0.0;  ///< Length of the step [s].
  int order = 0;   ///< Order of the method.
  /// Error estimate in the method's weighted norm, where 1 is the tolerance; NaN where the method has none.
  double error = 0.0;
  int newton_iterations = 0;             ///< Newton iterations in this attempt.
  Outcome outcome = Outcome::kAccepted;  ///< Outcome of the attempt.
  /// Entry of u (a node's axis, a rigid body's direction) with the largest contribution to the error; -1:
  /// unknown.
  int worst_dof = -1;
  /// Most inverted element at the attempted state, of the first term that has one; -1: none.
  int inverted_element = -1;
  std::string inverted_in;  ///< Name of the term that the element belongs to.
  /// The attempt is 1/2^halvings of a fixed step; 0: the whole step.
  int halvings = 0;
};
/// Returns the name of an outcome for traces.
const char* to_string(StepAttempt::Outcome outcome);

/// Receiver of a record of every attempted step.
class StepTrace {
 public:
  virtual ~StepTrace() = default;
  /// Called after each attempted step.
  virtual void attempt(const StepAttempt& attempt) = 0;
};

class Stepper;

/// Receiver of accepted steps, for a loop that needs the solution at more times than the stepper is advanced
/// to. Called after every accepted step while its interpolant is valid: dense_output is then defined for
/// times in [t0, t1], and the State is at t1.
class StepFollower {
 public:
  virtual ~StepFollower() = default;
  /// Called after each accepted step from t0 to t1 [s]; the stepper's dense output covers it.
  virtual void stepped(const Stepper& stepper, double t0, double t1) = 0;
};

/// Advances the State of a System in time.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// Returns the name used in scenes.
  virtual std::string name() const = 0;
  /// Steps to exactly t_end (> state time). On success the State's time is t_end; on failure the State holds
  /// the last successful step.
  virtual StepResult advance_to(double t_end) = 0;
  /// Performs one-time work (symbolic analysis, allocation) ahead of the first step, so that it is no slower
  /// than the rest. The State is unchanged, and so are later results, to within the tolerance of a linear
  /// solver that starts from earlier solutions.
  /// The argument is the interval of the following calls of advance_to() [s].
  virtual void prepare(double /*interval*/) {}
  /// Computes q and u at a time within the last step (or between the last two outputs), by the method's
  /// interpolant. Returns false where t is outside.
  virtual bool dense_output(double t, VecX& q, VecX& u) const = 0;
  /// Discards the history, after a change of the right-hand side or of the State by the caller.
  virtual void reinit(ReinitReason reason) = 0;
  /// Returns the work done since construction.
  virtual const StepperCounters& counters() const = 0;

  /// Sets the receiver of a record of every attempted step from now on; null for none. Without a trace the
  /// cost of a step is unchanged.
  void set_trace(StepTrace* trace) { trace_ = trace; }
  /// Sets the receiver of every accepted step from now on; null for none. Returns false where the method does
  /// not support it: the stepper must then be advanced to each time of interest.
  virtual bool follow(StepFollower*) { return false; }
  /// Sets a flag which, when true, makes advance_to return after the current step with kInterrupted and the
  /// last successful state; null for none.
  void set_interrupt(const std::atomic<bool>* flag) { interrupt_ = flag; }

 protected:
  /// Returns the trace; null without one.
  StepTrace* trace() const { return trace_; }
  /// Returns whether the flag of set_interrupt() is set.
  bool interrupted() const { return interrupt_ && interrupt_->load(std::memory_order_relaxed); }

 private:
  StepTrace* trace_ = nullptr;
  const std::atomic<bool>* interrupt_ = nullptr;
};

/// Step control of a method: by rtol, by step_s, or by either, as chosen by fixed_step.
enum class StepControl { kAdaptive, kFixed, kEither };
/// Stability of a method on stiff, stable problems.
enum class Stability {
  kExplicit,  ///< Stable up to a step that is bounded by the largest frequency.
  kStatic,    ///< No dynamics: equilibria.
  kAlpha,     ///< A(alpha)-stable: a sector of the left half plane (BDF 3 to 5).
  kA,         ///< A-stable: every stable linear problem decays, at any step.
  kL,         ///< A-stable, and infinitely stiff modes vanish in one step (L-stable).
};
/// Returns the stability in words, as printed by `palpate list integrators`.
const char* to_string(Stability stability);

/// Theoretical properties of one method, used by the conformance suite, the stability matrix, reports and
/// `palpate list`.
struct StepperTraits {
  /// "BDF", "DIRK", "explicit Runge-Kutta". References are checked across families.
  std::string family;
  int order = 1;  ///< Order on a smooth, non-stiff problem; the highest of a variable-order method.
  /// Order for a stiff, strongly damped mode that the step does not resolve (order reduction); 0: unstable
  /// there.
  int stiff_order = 1;
  StepControl control = StepControl::kFixed;   ///< How its steps are chosen.
  Stability stability = Stability::kExplicit;  ///< Stability on stiff problems.
  bool implicit = false;                       ///< Needs tangents and a linear solver.
  bool multistep = false;                      ///< Discards its history at every re-initialisation.
  /// Requirements on the system, in words: "force", "force, tangent", "tool or contact as the fast part".
  std::string needs;
  /// Linear solver where the spec specifies none. "auto" where a matrix is used for one or two solves, as in
  /// the measurements by which it chooses; a direct solver where a factor is reused for many.
  std::string linear_solver = "cholmod";
  /// One linear solve per step, without iteration: an approximate tangent is a choice of the method and does
  /// not degrade convergence.
  bool linearised = false;
};

/// Factory of a stepper for a system and a state, both of which must outlive it.
using MakeStepper = std::unique_ptr<Stepper> (*)(System&, State&, const IntegratorSpec&,
                                                 std::unique_ptr<LinearSolver>);
/// One integrator of the registry.
struct StepperEntry {
  std::string name;                ///< Name used in scenes.
  std::string summary;             ///< One line.
  StepperTraits traits;            ///< Theoretical properties.
  MakeStepper make;                ///< Factory; the linear solver is null for an explicit method.
  std::vector<PartKey> keys = {};  ///< Keys of [integrator] that the method uses.
  /// Relative tolerance that the method's error test must use so that the error over a given time is
  /// proportional to spec.rtol. Null for methods without an error test; with fixed_step it has no meaning.
  double (*error_test_rtol)(const IntegratorSpec& spec) = nullptr;
  /// Smallest rtol that the method accepts with this spec; below it the error would be dominated by rounding.
  /// Null where error_test_rtol is null.
  double (*tightest_rtol)(const IntegratorSpec& spec) = nullptr;
};
/// All integrators.
using StepperRegistry = std::vector<StepperEntry>;

}  // namespace palpate::dynamics
