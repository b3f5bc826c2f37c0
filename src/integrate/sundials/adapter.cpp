#include "integrate/sundials/adapter.h"

#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_newton.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/counters.h"
#include "integrate/sundials/check.h"
#include "integrate/sundials/vector_ops.h"
#include "palpate/core/error.h"

namespace palpate::integrate::sun {
namespace {

using dynamics::SolveStatus;
using dynamics::StepAttempt;
using dynamics::StepResult;
using dynamics::StepStatus;

// Successful return values of a step: the same numbers in CVODE, ARKODE and IDA.
constexpr int kReachedStop = 1, kReachedRoot = 2;

/// Returns the step length below which a call ends with an error. Ahead of a force that is not finite from
/// some time on, steps would otherwise shrink towards that time without end. Far below any physical time
/// scale, above the rounding of t.
double smallest_step(double t, double t_end) {
  return std::max(tuning::kSmallestStep * (t_end - t), 1e-15 * std::max(std::abs(t), std::abs(t_end)));
}

}  // namespace

Adapter::Adapter(std::unique_ptr<OdeProblem> problem, const IntegratorSpec& spec)
    : problem_(std::move(problem)), spec_(spec) {
  counters::count("integrate." + spec_.name);
}
Adapter::~Adapter() { release(); }

// --- memory

void Adapter::allocate() {
  context_.emplace(on_error, this);
  y_ = N_VNew_Serial(problem_->size(), context());
  check(y_, "N_VNew_Serial");
  use_fast_operations(y_);
  scratch_ = N_VClone(y_);
  weights_ = N_VClone(y_);
}

void Adapter::release() {
  for (N_Vector* v : {&y_, &scratch_, &weights_}) {
    if (*v) N_VDestroy(*v);
    *v = nullptr;
  }
  if (newton_) SUNNonlinSolFree(newton_);
  newton_ = nullptr;
  fixed_step_newton_.release();
  context_.reset();
}

void Adapter::start() {
  // Between two calls y_ is the current state.
  if (running_ && finds_roots() && roots_version_ != problem_->events_version()) {
    running_ = false;
    keep_step_ = true;
  }
  if (running_) return;
  const bool fits = made_ && version_ == problem_->version();
  if (!fits) {
    destroy();
    release();
    allocate();
  }
  problem_->load(NV_DATA_S(y_));
  if (fits)
    restart(keep_step_);
  else
    create();
  made_ = true;
  version_ = problem_->version();
  const int roots_now = finds_roots() ? problem_->event_count() : 0;
  if (!fits || roots_now != root_count_) find_roots(roots_now);
  root_count_ = roots_now;
  roots_version_ = problem_->events_version();
  counted_ = counts();
  running_ = true;
  keep_step_ = false;
}

// --- stepping

StepResult Adapter::advance_to(double t_end) {
  PALPATE_CHECK(t_end > problem_->time(), "t_end = {} must be later than t = {}", t_end, problem_->time());
  if (problem_->size() == 0) {  // No body: only time advances.
    problem_->set_time(t_end);
    StepResult result;
    result.t = t_end;
    return result;
  }
  start();
  aim(t_end, smallest_step(problem_->time(), t_end));
  message_.clear();
  double t = problem_->time();
  int flag = 0;
  int n = 0;
  for (; n < spec_.max_steps && flag >= 0 && flag != kReachedStop && !interrupted(); ++n) {
    const double before = t;
    newton_before_ = counts().newton_iterations;
    if (trace()) {
      attempt_start_ = attempt_reach_ = t;
      attempt_counts_ = counts();
      attempt_open_ = false;
    }
    double reached = t;
    flag = one_step(t_end, reached);
    if (flag >= 0) t = reached;  // After a failure the time may belong to a stage.
    // A library may return either flag at the end of a step: it depends on the release.
    if (flag == 0 && t >= t_end) flag = kReachedStop;
    if (trace() && flag >= 0) accept_attempt(before, t, flag == kReachedRoot);
    if (trace() && flag < 0 && attempt_open_)
      close_attempt(attempt_finite_ ? StepAttempt::Outcome::kNewton : StepAttempt::Outcome::kNotFinite);
    if (follower_ && flag >= 0 && t > before) {
      problem_->store(flag == kReachedStop ? t_end : t, NV_DATA_S(y_));
      collect();
      follower_->stepped(*this, before, problem_->time());
    }
    if (flag != kReachedRoot || t >= t_end) {
      if (flag == kReachedRoot) flag = kReachedStop;
      continue;
    }
    collect();
    problem_->store(t, NV_DATA_S(y_));
    ++problem_->counters().events;
    running_ = false;
    keep_step_ = true;
    start();
    aim(t_end, smallest_step(t, t_end));
  }
  const bool landed = flag == kReachedStop;
  problem_->store(landed ? t_end : t, NV_DATA_S(y_));
  collect();
  context_->log_warnings();
  if (landed) return result(StepStatus::kOk);
  running_ = false;                            // The next call starts from the State.
  if (interrupted() && n < spec_.max_steps) {  // Between two steps, or within one that checked the flag.
    StepResult stopped = result(StepStatus::kInterrupted);
    stopped.message = fmt::format("{}: interrupted at t = {}, h = {}", name(), t, stopped.h);
    return stopped;
  }
  return failure(flag, t, t_end);
}

StepResult Adapter::failure(int flag, double t, double t_end) {
  StepResult failed = result(flag >= 0 ? StepStatus::kTooManySteps : status_of(flag));
  // A force that is not finite is the reason why the iteration could not converge.
  if (!finite_ && failed.status == StepStatus::kNewtonFailed) failed.status = StepStatus::kNotFinite;
  if (flag >= 0) message_ = fmt::format("reached max_steps = {} before t_end = {}", spec_.max_steps, t_end);
  failed.message =
      fmt::format("{}: {} at t = {}, h = {:.9g}: {}", name(), flag >= 0 ? "TOO_MUCH_WORK" : flag_name(flag),
                  t, failed.h, message_ + remedy(flag));
  return failed;
}

StepResult Adapter::result(StepStatus status) const {
  StepResult r;
  r.status = status;
  r.t = problem_->time();
  r.h = last_step();
  r.order = last_order();
  r.iterations = static_cast<int>(counts().newton_iterations - newton_before_);
  r.residual = last_correction_;
  return r;
}

bool Adapter::dense_output(double t, VecX& q, VecX& u) const {
  if (!running_ || counted_.steps == 0 || t > problem_->time() || !interpolate(t, scratch_)) return false;
  problem_->finish(t, NV_DATA_S(scratch_), q, u);
  return true;
}

void Adapter::reinit(dynamics::ReinitReason reason) {
  ++problem_->counters().reinits;
  keep_step_ = (running_ || keep_step_) && reason == dynamics::ReinitReason::kContactRefreshed;
  running_ = false;
}

const dynamics::StepperCounters& Adapter::counters() const {
  problem_->collect_solver_counters();
  return problem_->counters();
}

/// Adds the library's counts since the last call. The library counts from its last start, these counters from
/// construction.
void Adapter::collect() {
  const Counts now = counts();
  dynamics::StepperCounters& c = problem_->counters();
  c.steps += now.steps - counted_.steps;
  c.error_test_failures += now.error_test_failures - counted_.error_test_failures;
  c.rejected +=
      now.error_test_failures + now.solve_failures - counted_.error_test_failures - counted_.solve_failures;
  c.newton_iterations += now.newton_iterations - counted_.newton_iterations;
  c.newton_failures += now.newton_failures - counted_.newton_failures;
  c.fast_steps += now.fast_steps - counted_.fast_steps;
  counted_ = now;
}

void Adapter::fill_weights(N_Vector y, N_Vector w) const {
  problem_->weights(NV_DATA_S(y), NV_DATA_S(w));
  if (weight_scale_ != 1.0) N_VScale(weight_scale_, w, w);
}

void Adapter::keep_state() { kept_ = Eigen::Map<const VecX>(NV_DATA_S(y_), NV_LENGTH_S(y_)); }
void Adapter::restore_state() { Eigen::Map<VecX>(NV_DATA_S(y_), NV_LENGTH_S(y_)) = kept_; }

// --- Newton

// The tangent is evaluated at every factorisation: it costs a fifteenth of one, and avoids failed Newton
// solves. Where the library would accept an old tangent and gamma is unchanged, the old factor is kept.
bool Adapter::prepare_matrix(double t, N_Vector y, bool reuse, double gamma, OdeProblem::Side side) {
  wanted_gamma_ = gamma;
  const bool fresh = !(reuse && gamma == problem_->gamma());
  if (fresh) problem_->evaluate_tangent(t, NV_DATA_S(y), side);
  fresh_matrix_ = fresh;
  return fresh;
}

int Adapter::setup() {
  if (interrupted()) return kUnrecoverable;  // A step may take many matrices.
  rate_ = 1.0;
  return problem_->factor(wanted_gamma_) == SolveStatus::kOk ? 0 : kRecoverable;
}

// Newton's test of convergence. With corrections d_0, d_1, .. that contract by rho, the error left after d_m
// is about rho d_m. SUNDIALS estimates rho as max(0.3 rho, d_m / d_(m-1)) and keeps it until the next
// factorisation. On an (almost) linear force the first solves after a fresh factor converge at once, and rho
// vanishes. When gamma then changes by up to 20 or 30 % with the factor kept, a first correction with an
// error of that size is accepted as exact: global errors of 1e-3 at rtol 1e-7. So rho is bounded from below
// by the effect of the old gamma: on a mode lambda, (1 - g' lambda)^-1 is used in place of (1 - g lambda)^-1,
// with a relative error of at most |g / g' - 1| at either end of the spectrum; and by a constant, for an old
// tangent.
// A fixed-point iteration has no matrix whose age could be bounded, and only the contraction observed in the
// same solve is used. With the rate that SUNDIALS keeps, cvode-adams accepts its first correction as exact,
// with errors of 20 to 130 times rtol where they are 5 times rtol with this test.
int Adapter::test_convergence(int iteration, double correction, double tolerance) {
  const double stale =
      fixed_point_ ? tuning::kOldTangent : std::abs(current_gamma() / problem_->gamma() - 1.0);
  if (fixed_point_ && iteration == 0) rate_ = 1.0;
  if (iteration > 0) {
    if (correction > tuning::kDivergingCorrection * previous_correction_) return SUN_NLS_CONV_RECVR;
    rate_ = std::max(tuning::kForgetContraction * rate_, correction / previous_correction_);
  }
  previous_correction_ = correction;
  const double rate = std::min(1.0, std::max({rate_, stale, tuning::kOldTangent}));
  if (!std::isfinite(correction)) return SUN_NLS_CONV_RECVR;
  return correction == 0.0 || rate * correction <= tolerance ? kSuccess : SUN_NLS_CONTINUE;
}

SUNNonlinearSolver Adapter::make_newton() {
  newton_ = SUNNonlinSol_Newton(y_, context());
  check(newton_, "SUNNonlinSol_Newton");
  by_library_newton_ = true;
  // The tolerance is an argument of the call; the data of the convergence test identify the adapter.
  newton_->ops->solve = [](SUNNonlinearSolver solver, N_Vector y0, N_Vector correction, N_Vector w,
                           sunrealtype tolerance, sunbooleantype set_up, void* memory) {
    auto* content = static_cast<SUNNonlinearSolverContent_Newton>(solver->content);
    static_cast<Adapter*>(content->ctest_data)->newton_tolerance_ = tolerance;
    return SUNNonlinSolSolve_Newton(solver, y0, correction, w, tolerance, set_up, memory);
  };
  return newton_;
}

SUNNonlinearSolver Adapter::make_fixed_step_newton() { return newton_ = fixed_step_newton_.make(context()); }

void Adapter::use_own_test(SUNNonlinearSolver fixed_point) {
  fixed_point_ = fixed_point != nullptr;
  const auto test = [](SUNNonlinearSolver solver, N_Vector, N_Vector correction, sunrealtype tolerance,
                       N_Vector w, void* data) {
    int iteration = 0;
    SUNNonlinSolGetCurIter(solver, &iteration);
    return static_cast<Adapter*>(data)->test_convergence(iteration, N_VWrmsNorm(correction, w), tolerance);
  };
  check(SUNNonlinSolSetConvTestFn(fixed_point_ ? fixed_point : newton_, test, this),
        "SUNNonlinSolSetConvTestFn", problem_->time(), 0.0);
}

SolveStatus Adapter::solve_newton(const double* y, const double* r, double* d) {
  return problem_->solve(y, r, d);
}

/// Counts Newton iterations with the factor of an earlier solve. The library counts the iterations of a solve
/// from 0, also where it starts again after a setup.
void Adapter::count_iteration() {
  int iteration = 0;
  check(SUNNonlinSolGetCurIter(newton_, &iteration), "SUNNonlinSolGetCurIter", problem_->time(), 0.0);
  if (iteration == 0) kept_matrix_ = !fresh_matrix_;
  fresh_matrix_ = false;
  problem_->counters().kept_matrix_iterations += kept_matrix_;
}

void Adapter::record_solve(int kept, bool definite_retry, bool leap) {
  dynamics::StepperCounters& c = problem_->counters();
  c.kept_matrix_iterations += kept;
  c.definite_retries += definite_retry;
  c.leaps += leap;
}

void Adapter::begin_part(int halvings) {
  dynamics::StepperCounters& c = problem_->counters();
  c.halved_steps += halvings_ == 0 && halvings > 0;
  c.most_halvings = std::max<long>(c.most_halvings, halvings);
  halvings_ = halvings;
}

void Adapter::end_part(bool done) { problem_->counters().step_parts += done && halvings_ > 0; }

int Adapter::solve(N_Vector x, N_Vector b) {
  if (interrupted()) return kUnrecoverable;
  if (by_library_newton_) count_iteration();
  fill_weights(newton_state(), weights_);
  if (by_library_newton_ && problem_->takes_error_limit())
    problem_->limit_error(NV_DATA_S(weights_), tuning::kLinearShare * newton_tolerance_);
  const SolveStatus status = solve_newton(NV_DATA_S(newton_state()), NV_DATA_S(b), NV_DATA_S(x));
  if (status != SolveStatus::kOk) return kRecoverable;
  last_correction_ = N_VWrmsNorm(x, weights_);
  if (trace()) attempt_worst_ = index_of_largest(x, weights_);
  return std::isfinite(last_correction_) ? 0 : kRecoverable;
}

// --- callbacks

namespace {
Adapter& self(void* data) { return *static_cast<Adapter*>(data); }
}  // namespace

void Adapter::on_error(const char* function, const char* text, void* data) {
  self(data).message_ = fmt::format("{}: {}", function, text);
}

int Adapter::weights(N_Vector y, N_Vector w, void* data) {
  self(data).fill_weights(y, w);
  return 0;
}

int Adapter::project_step(sunrealtype, N_Vector y, void* data) {
  self(data).problem_->project(NV_DATA_S(y));
  return 0;
}

int Adapter::roots(sunrealtype t, N_Vector y, sunrealtype* g, void* data) {
  self(data).problem_->events(t, NV_DATA_S(y), g);
  return 0;
}

}  // namespace palpate::integrate::sun
