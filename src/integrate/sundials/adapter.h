#pragma once
#include <sundials/sundials_context.h>
#include <sundials/sundials_nonlinearsolver.h>
#include <sundials/sundials_nvector.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "integrate/ode_problem.h"
#include "integrate/sundials/fixed_step_newton.h"
#include "integrate/sundials/hidden.h"
#include "integrate/sundials/hooks.h"
#include "integrate/sundials/release.h"
#include "integrate/tuning.h"
#include "palpate/dynamics/spec.h"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

constexpr int kRecoverable = 1;
constexpr int kUnrecoverable = -1;

/// Common part of the CVODE, ARKODE and IDA integrators as a Stepper: memory allocated once per layout,
/// restarts, landing on the output time, root finding with a restart at the root, counters across restarts,
/// the trace, errors with the flag's name, time and step. A derived class contains the calls of one library.
class Adapter : public dynamics::Stepper, protected NewtonHook {
 public:
  Adapter(std::unique_ptr<OdeProblem> problem, const IntegratorSpec& spec);
  // Derived classes free their memory in their destructors, before the vectors are destroyed.
  ~Adapter() override;
  Adapter(const Adapter&) = delete;
  Adapter& operator=(const Adapter&) = delete;

  std::string name() const override { return spec_.name; }
  dynamics::StepResult advance_to(double t_end) final;
  bool dense_output(double t, VecX& q, VecX& u) const final;
  void reinit(dynamics::ReinitReason reason) final;
  bool follow(dynamics::StepFollower* follower) final {
    follower_ = follower;
    return true;
  }
  const dynamics::StepperCounters& counters() const final;

 protected:
  /// Counts of a library since its last start.
  struct Counts {
    long steps = 0, error_test_failures = 0, newton_iterations = 0, newton_failures = 0, solve_failures = 0,
         fast_steps = 0;
  };

  // --- interface to one library
  virtual void create() = 0;   ///< Creates the library's memory, for y() at problem().time().
  virtual void destroy() = 0;  ///< Frees it; does nothing when there is none.
  /// Restarts from y() at problem().time() and discards the history; a one-step method may keep its step
  /// size.
  virtual void restart(bool keep_step) = 0;
  /// Sets the number of root functions.
  virtual void find_roots(int count) = 0;
  /// Sets the time to land on and the smallest step [s].
  virtual void aim(double t_end, double smallest_step) = 0;
  /// Takes one step and returns the library's flag; y() becomes the solution at t.
  virtual int one_step(double t_end, double& t) = 0;
  virtual dynamics::StepStatus status_of(int flag) const = 0;
  virtual std::string flag_name(int flag) const = 0;
  /// Returns advice for flags whose names mislead.
  virtual std::string remedy(int /*flag*/) const { return {}; }
  virtual bool interpolate(double t, N_Vector out) const = 0;
  virtual Counts counts() const = 0;
  virtual double last_step() const = 0;
  virtual int last_order() const = 0;
  /// Estimates the local errors of the last accepted step; returns false where the library has no estimate.
  virtual bool local_errors(N_Vector /*estimate*/) const { return false; }
  /// Returns y at the current Newton iterate.
  virtual N_Vector newton_state() const = 0;
  /// Returns gamma of the current step; the factor may belong to another one.
  virtual double current_gamma() const = 0;

  // --- services for derived classes
  OdeProblem& problem() const { return *problem_; }
  const IntegratorSpec& spec() const { return spec_; }
  SUNContext context() const { return *context_; }
  /// Redirects the library's errors. Must be called first, so that SUNDIALS prints nothing.
  void report_errors(Solver solver, void* memory) { context_->attach(solver, memory); }
  N_Vector y() const { return y_; }
  N_Vector scratch() const { return scratch_; }
  /// Uses `rtol` in place of the spec's (error_test.h).
  void use_tolerance(double rtol) { weight_scale_ = spec_.rtol / rtol; }
  void keep_state();  ///< Stores y() at the start of a step that may be repeated.
  /// Restores y() as stored by keep_state().
  void restore_state();
  /// Must be called at every evaluation of the right-hand side: separates attempted steps while they are
  /// traced.
  void trace_evaluation(double t, N_Vector y, bool finite);

  int setup() override;
  int solve(N_Vector x, N_Vector b) override;
  N_Vector iterate() const override { return newton_state(); }
  void project_to_psd(bool on) override { problem_->project_to_psd(on); }
  void record_solve(int kept, bool definite_retry, bool leap) override;
  /// Solves with Newton's matrix; by default in first-order form.
  virtual dynamics::SolveStatus solve_newton(const double* y, const double* r, double* d);
  /// Makes SUNDIALS' Newton iteration with the convergence test of this class. Made with the library's
  /// memory, freed by this class.
  SUNNonlinearSolver make_newton();
  /// Makes the nonlinear solver for steps that cannot be shortened, used in place of make_newton().
  SUNNonlinearSolver make_fixed_step_newton();
  void allow_leaps(bool on) { fixed_step_newton_.allow_leaps(on); }
  void begin_part(int halvings);  ///< Called before 1/2^halvings of a fixed step is attempted.
  /// Called after that attempt.
  void end_part(bool done);
  /// Installs the convergence test. Must be called after the nonlinear solver was passed to the library,
  /// which sets its default test.
  /// @param fixed_point  solver used in place of the one of make_newton()
  void use_own_test(SUNNonlinearSolver fixed_point = nullptr);

  /// Re-evaluates the tangent unless the factor can be kept. Must be called by the library's matrix callback.
  bool prepare_matrix(double t, N_Vector y, bool reuse, double gamma, OdeProblem::Side side);

  static void on_error(const char* function, const char* text, void* data);
  static int weights(N_Vector y, N_Vector w, void* data);
  static int project_step(sunrealtype t, N_Vector y, void* data);  ///< Post-process function of ARKODE.
  static int roots(sunrealtype t, N_Vector y, sunrealtype* g, void* data);

 private:
  void start();
  void count_iteration();
  void allocate();
  void release();
  void collect();
  dynamics::StepAttempt attempt(double t0, double t1, dynamics::StepAttempt::Outcome outcome) const;
  void close_attempt(dynamics::StepAttempt::Outcome outcome);
  void accept_attempt(double t0, double t1, bool event);
  dynamics::StepResult result(dynamics::StepStatus status) const;
  dynamics::StepResult failure(int flag, double t, double t_end);
  int test_convergence(int iteration, double correction, double tolerance);

  std::unique_ptr<OdeProblem> problem_;
  IntegratorSpec spec_;
  std::optional<Context> context_;
  N_Vector y_ = nullptr, scratch_ = nullptr, weights_ = nullptr;
  SUNNonlinearSolver newton_ = nullptr;
  double newton_tolerance_ = 0.0;  ///< Tolerance of the current nonlinear solve.
  bool fixed_point_ = false, by_library_newton_ = false, fresh_matrix_ = false, kept_matrix_ = false;
  FixedStepNewton fixed_step_newton_{*this};
  double rate_ = 1.0, previous_correction_ = 0.0;  ///< Contraction of Newton's iteration.
  void fill_weights(N_Vector y, N_Vector w) const;
  bool finds_roots() const { return spec_.events == KinkTreatment::kRootFinding; }
  double weight_scale_ = 1.0;
  Counts counted_;  ///< Counts when last read.
  long newton_before_ = 0;
  double last_correction_ = 0.0;  ///< Weighted norm of the last Newton correction.
  int halvings_ = 0;              ///< Halvings of the current fixed step.
  dynamics::StepFollower* follower_ = nullptr;
  bool made_ = false, running_ = false, keep_step_ = false;
  bool finite_ = true;  ///< Whether the last evaluation was finite.
  std::uint64_t version_ = 0;
  int root_count_ = 0;
  std::uint64_t roots_version_ = 0;  ///< Version of the event functions whose values the library holds.
  double wanted_gamma_ = 0.0;
  std::string message_;

  // State of the traced attempt.
  Counts attempt_counts_;
  double attempt_start_ = 0.0, attempt_reach_ = 0.0;
  int attempt_worst_ = -1, attempt_halvings_ = 0;
  bool attempt_finite_ = true, attempt_open_ = false;
  VecX attempt_y_;

  VecX kept_;
};

}  // namespace sun
}  // namespace palpate::integrate
