#include <kinsol/kinsol.h>
#include <kinsol/kinsol_ls.h>
#include <nvector/nvector_serial.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/clock.h"
#include "core/counters.h"
#include "core/finite.h"
#include "integrate/make.h"
#include "integrate/settings.h"
#include "integrate/static_equations.h"
#include "integrate/step_solver.h"
#include "integrate/sundials/check.h"
#include "integrate/sundials/hooks.h"
#include "integrate/sundials/release.h"
#include "integrate/sundials/vector_ops.h"
#include "integrate/tuning.h"
#include "palpate/core/error.h"

namespace palpate::integrate {
namespace sun {
namespace {

using namespace dynamics;

constexpr int kRecoverable = 1;

/// Quasi-static equilibrium, f(q, 0, t) = 0, by Newton's method of SUNDIALS KINSOL with the exact tangent at
/// every iteration. The State at t_end is the equilibrium at t_end, reached from the previous one; velocities
/// are zero.
///
/// Load stepping. From q0 at t0, which need not be in equilibrium, to t1, the unbalanced force is released in
/// load steps s in (0, 1],
///     G(q, s) = f(q, 0, t0 + s (t1 - t0)) - (1 - s) f(q0, 0, t0) = 0,
/// where s = 0 is solved by q0: loads, drives and the unbalanced force left by earlier outputs all vary with
/// s. A load step at which Newton's method fails is halved.
///
/// Proximal steps. Where even a load step of 1/64 fails (a strut that buckles, a body supported only by its
/// contact) it is solved by
///     G(q, s) - sigma M (q - q_k) = 0,
/// with sigma reduced by ten after a success and increased by ten after a failure. These are steps of
/// backward Euler without inertia, which decrease the energy, have a definite matrix for sigma large enough,
/// and end at a stable equilibrium. (KINSOL's line search stalls here: the norm of the force is no merit
/// function when an element rotates.)
///
/// Convergence. Forces are measured by the largest one that any term exerts on a free direction, moments by
/// the largest moment, or by that force at a lever arm as long as the simulated objects. Newton's method
/// stops at a residual of newton_rtol relative to that, or at the rounding of the residual, if that is more:
/// a position is known to eps of its size, so that the force on direction i is known to
///     rounding_i = 1e-14 sum_j |K_ij| X_j,      X_j the largest coordinate of any node; 1 for angles.
/// For small loads the second bound applies. Such an equilibrium is counted as limited by rounding, and
/// corrections with the last factor continue while they lower the residual. No bound depends on a unit; the
/// one absolute figure is where doubles lose digits to underflow, 1e-292 (a State of displacements whose
/// equilibrium is computed repeatedly divides them by 1e16 each time, and reaches it).
class KinsolStatic final : public Stepper, private NewtonHook {
 public:
  KinsolStatic(System& system, State& state, const IntegratorSpec& spec, std::unique_ptr<LinearSolver> solver)
      : system_(system),
        state_(state),
        spec_(spec),
        solver_(std::move(solver), spec),
        equations_(system, state, counters_) {
    check_static(spec);
    clamped_before_ = system.clamped_tangents();
    counters::count("integrate.kinsol-static");
  }
  ~KinsolStatic() override { release(); }

  std::string name() const override { return "kinsol-static"; }

  StepResult advance_to(double t_end) override {
    PALPATE_CHECK(t_end > state_.time(), "t_end = {} must be later than t = {}", t_end, state_.time());
    const int n = state_.layout().u_size;
    if (n == 0) {
      state_.set_time(t_end);
      return succeeded(0.0, 0);
    }
    allocate();
    t0_ = state_.time();
    t1_ = t_end;
    q_start_ = state_.q();
    u_start_ = state_.u();
    state_.u().setZero();
    if (!equations_.begin(t1_)) return failure(StepStatus::kNotFinite, "the force is not finite");
    Eigen::Map<VecX>(NV_DATA_S(displacement_scale_), n) = equations_.displacement_scale();
    Eigen::Map<VecX>(NV_DATA_S(force_scale_), n) = equations_.force_scale();
    start_tolerance_ = std::max(spec_.newton_rtol, equations_.rounding());
    const StepResult result = climb();
    if (!result.ok()) {
      state_.q() = q_start_;
      state_.u() = u_start_;
    }
    return result;
  }

  bool dense_output(double t, VecX& q, VecX& u) const override {
    if (q_start_.size() != state_.layout().q_size || t < t0_ || t > state_.time() || !(state_.time() > t0_))
      return false;
    const double s = (t - t0_) / (state_.time() - t0_);
    q = (1.0 - s) * q_start_ + s * state_.q();
    u = VecX::Zero(state_.layout().u_size);
    project(state_.layout(), q.data());
    system_.impose(state_.layout(), t, q.data(), u.data());
    return true;
  }
  void reinit(ReinitReason) override { ++counters_.reinits; }
  const StepperCounters& counters() const override {
    solver_.report(counters_);
    counters_.clamped = system_.clamped_tangents() - clamped_before_;
    return counters_;
  }

 private:
  // --- load steps
  StepResult climb() {
    double s = 0.0, load_step = 1.0;
    int flag = KIN_SUCCESS;
    bool halved = false;
    long iterations = 0;
    while (s < 1.0) {
      if (interrupted()) return failure(StepStatus::kInterrupted, "interrupted");
      equations_.load = std::min(1.0, s + load_step);
      equations_.sigma = 0.0;
      flag = solve(iterations);
      if (flag < 0 && load_step > tuning::kShortestLoadStep) {
        ++counters_.rejected;
        counters_.halved_steps += !halved;
        halved = true;
        load_step *= 0.5;
        counters_.most_halvings = std::max<long>(counters_.most_halvings, std::lround(-std::log2(load_step)));
        continue;
      }
      if (flag < 0 && !take_proximal_steps(flag, iterations)) return failure(status_of(flag), describe(flag));
      accept_rung();
      counters_.step_parts += halved;
      s = equations_.load;
      load_step = std::min(2.0 * load_step, 1.0);
    }
    state_.set_time(t1_);
    system_.impose(state_.layout(), t1_, state_.q().data(), state_.u().data());
    state_.u().setZero();
    return succeeded(t1_ - t0_, static_cast<int>(iterations));
  }

  /// Takes proximal steps to the load of the equations.
  /// @param flag  KINSOL's last flag
  bool take_proximal_steps(int& flag, long& iterations) {
    double& sigma = equations_.sigma;
    sigma = equations_.stiffness_over_mass();
    if (!(sigma > 0.0)) return false;
    const double largest = 1e6 * sigma;
    for (int k = 0; k < tuning::kProximalSteps && !interrupted(); ++k) {
      flag = solve(iterations);
      if (flag < 0) {
        ++counters_.rejected;
        sigma *= 10.0;
        if (!(sigma <= largest)) return false;
        continue;
      }
      accept_rung();
      ++counters_.downhill;
      VecX left;
      N_VConst(0.0, x_);
      if (!equations_.residual(NV_DATA_S(x_), 0.0, left)) return false;
      if (equations_.size_of(left) <= tolerance_) {
        if (equations_.size_of(left) > spec_.newton_rtol) ++counters_.rounding_limited;
        return true;
      }
      sigma *= 0.1;
    }
    flag = KIN_MAXITER_REACHED;
    return false;
  }

  void accept_rung() {
    equations_.accept(NV_DATA_S(x_));
    ++counters_.steps;
  }

  /// Solves once by Newton's method for the displacement x_ from the last accepted positions.
  int solve(long& iterations) {
    N_VConst(0.0, x_);
    message_.clear();
    finite_ = true;
    set_tolerance(start_tolerance_);
    // Where sigma = 0, a step that moves no position is the last; proximal steps may be arbitrarily small.
    check(KINSetScaledStepTol(
              kinsol_, equations_.sigma == 0.0 ? std::numeric_limits<double>::epsilon() : kSmallestLength),
          "KINSetScaledStepTol", state_.time(), 0.0);
    int flag = KINSol(kinsol_, x_, KIN_NONE, displacement_scale_, force_scale_);
    context_->log_warnings();
    long now = 0;
    check(KINGetNumNonlinSolvIters(kinsol_, &now), "KINGetNumNonlinSolvIters", state_.time(), 0.0);
    iterations += now;
    counters_.newton_iterations += now;
    if (flag == KIN_STEP_LT_STPTOL) flag = ends_at_rounding() ? KIN_SUCCESS : KIN_MAXITER_REACHED;
    if (flag >= 0 && equations_.sigma == 0.0 && tolerance_ > spec_.newton_rtol && !refine())
      flag = KIN_MAXITER_REACHED;
    if (flag < 0) ++counters_.newton_failures;
    return flag;
  }

  /// Returns whether the residual is rounding, after positions stopped moving.
  bool ends_at_rounding() {
    return equations_.residual(NV_DATA_S(x_), equations_.sigma, g_) && equations_.size_of(g_) <= tolerance_;
  }

  /// Called where Newton's method ended at rounding. Verifies this with the matrix at the solution (the last
  /// matrix may belong to another state), and applies corrections while they lower the residual. Returns
  /// false where the residual is more than rounding.
  bool refine() {
    Eigen::Map<VecX> x(NV_DATA_S(x_), g_.size());
    if (!equations_.residual(x.data(), equations_.sigma, g_)) return false;
    double size = equations_.size_of(g_);
    if (size <= spec_.newton_rtol) return true;
    equations_.assemble();
    if (size > equations_.rounding()) return false;
    ++counters_.rounding_limited;
    if (setup() != 0) return true;  // A free body at rest.
    for (int k = 0; k < tuning::kRefinements && size > spec_.newton_rtol; ++k) {
      rhs_ = g_;
      if (solve_for_step() != 0) break;
      kept_ = x;
      x += step_;
      const double before = size;
      if (!equations_.residual(x.data(), equations_.sigma, g_) ||
          !((size = equations_.size_of(g_)) < before)) {
        x = kept_;
        break;
      }
      if (size > tuning::kRefinementHelps * before) break;
    }
    return true;
  }

  void set_tolerance(double tolerance) {
    tolerance_ = tolerance;
    check(KINSetFuncNormTol(kinsol_, tolerance), "KINSetFuncNormTol", state_.time(), 0.0);
  }

  static KinsolStatic& self(void* data) { return *static_cast<KinsolStatic*>(data); }
  static int equations(N_Vector x, N_Vector g, void* data) {
    KinsolStatic& me = self(data);
    me.finite_ = me.equations_.residual(NV_DATA_S(x), me.equations_.sigma, me.g_);
    if (!me.finite_) return kRecoverable;
    Eigen::Map<VecX>(NV_DATA_S(g), me.g_.size()) = -me.g_;  // Its derivative is then K.
    return 0;
  }
  static int jacobian(N_Vector x, N_Vector, SUNMatrix, void* data, N_Vector, N_Vector) {
    KinsolStatic& me = self(data);
    StaticEquations& equations = me.equations_;
    const ScopedTimer timer(me.counters_.tangent_s);
    ++me.counters_.tangent_evaluations;
    equations.assemble_at(NV_DATA_S(x));
    if (equations.sigma == 0.0) me.set_tolerance(std::max(me.spec_.newton_rtol, equations.rounding()));
    return 0;
  }
  int setup() override {
    const SolveStatus status =
        solver_.factor(equations_.matrix(), system_, [this] { equations_.assemble(); });
    return status == SolveStatus::kOk ? 0 : kRecoverable;
  }
  int solve(N_Vector x, N_Vector b) override {
    rhs_ = Eigen::Map<const VecX>(NV_DATA_S(b), NV_LENGTH_S(b));
    if (const int failed = solve_for_step(); failed != 0) return failed;
    Eigen::Map<VecX>(NV_DATA_S(x), step_.size()) = step_;
    return 0;
  }
  int solve_for_step() {
    for (int dof : system_.driven_dofs()) rhs_[dof] = 0.0;
    const auto right_hand_side = [this]() -> const VecX& { return rhs_; };
    if (solver_.solve(
            system_, [this] { equations_.assemble(); }, right_hand_side, step_) != SolveStatus::kOk ||
        !all_finite(step_))
      return kRecoverable;
    return 0;
  }

  // --- KINSOL
  void allocate() {
    if (kinsol_ && layout_version_ == state_.layout().version) return;
    release();
    const double t = state_.time();
    context_ = std::make_unique<Context>(on_error, this);
    x_ = N_VNew_Serial(state_.layout().u_size, *context_);
    check(x_, "N_VNew_Serial");
    use_fast_operations(x_);
    displacement_scale_ = N_VClone(x_);
    force_scale_ = N_VClone(x_);
    kinsol_ = KINCreate(*context_);
    check(kinsol_, "KINCreate");
    context_->attach(Solver::kKinsol, kinsol_);  // First, so that nothing is printed.
    check(KINInit(kinsol_, equations, x_), "KINInit", t, 0.0);
    check(KINSetUserData(kinsol_, this), "KINSetUserData", t, 0.0);
    linear_solver_ = make_linear_solver(*this, *context_);
    matrix_ = make_matrix(*context_);
    check(KINSetLinearSolver(kinsol_, linear_solver_, matrix_), "KINSetLinearSolver", t, 0.0);
    check(KINSetJacFn(kinsol_, jacobian), "KINSetJacFn", t, 0.0);
    // One tangent per iteration: with an old one Newton's method diverges on soft bodies.
    check(KINSetMaxSetupCalls(kinsol_, 1), "KINSetMaxSetupCalls", t, 0.0);
    check(KINSetNumMaxIters(kinsol_, tuning::kStaticIterations), "KINSetNumMaxIters", t, 0.0);
    // Load stepping keeps steps short.
    check(KINSetMaxNewtonStep(kinsol_, 1e30), "KINSetMaxNewtonStep", t, 0.0);
    layout_version_ = state_.layout().version;
  }

  void release() {
    if (kinsol_) KINFree(&kinsol_);
    if (linear_solver_) SUNLinSolFree(linear_solver_);
    if (matrix_) SUNMatDestroy(matrix_);
    for (N_Vector* v : {&x_, &displacement_scale_, &force_scale_}) {
      if (*v) N_VDestroy(*v);
      *v = nullptr;
    }
    context_.reset();
    linear_solver_ = nullptr;
    matrix_ = nullptr;
  }

  static void on_error(const char* function, const char* text, void* data) {
    self(data).message_ = fmt::format("{}: {}", function, text);
  }

  // --- results
  StepStatus status_of(int flag) const {
    if (!finite_) return StepStatus::kNotFinite;
    return flag == KIN_LSETUP_FAIL || flag == KIN_LSOLVE_FAIL || flag == KIN_LINSOLV_NO_RECOVERY
               ? StepStatus::kSolverFailed
               : StepStatus::kNewtonFailed;
  }
  std::string describe(int flag) const {
    return fmt::format(
        "{} at {:.3g} of the load: no equilibrium found ({}). Check that the body is held by attachments and "
        "that the load is not too large",
        flag_name("KINSol", flag), equations_.load, message_);
  }
  StepResult failure(StepStatus status, const std::string& what) const {
    StepResult r;
    r.status = status;
    r.t = t0_;
    r.h = t1_ - t0_;
    r.order = 1;
    r.message = fmt::format("kinsol-static: {} (t = {}, h = {})", what, t0_, r.h);
    return r;
  }
  StepResult succeeded(double h, int iterations) const {
    StepResult r;
    r.t = state_.time();
    r.h = h;
    r.order = 1;
    r.iterations = iterations;
    return r;
  }

  System& system_;
  State& state_;
  IntegratorSpec spec_;
  StepSolver solver_;
  mutable StepperCounters counters_;
  long clamped_before_ = 0;
  StaticEquations equations_;
  VecX q_start_, u_start_, g_, rhs_, step_, kept_;
  double t0_ = 0.0, t1_ = 0.0, start_tolerance_ = 0.0, tolerance_ = 0.0;
  bool finite_ = true;
  std::string message_;
  std::uint64_t layout_version_ = 0;
  std::unique_ptr<Context> context_;
  N_Vector x_ = nullptr, displacement_scale_ = nullptr, force_scale_ = nullptr;
  SUNLinearSolver linear_solver_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  void* kinsol_ = nullptr;
};

}  // namespace
}  // namespace sun

std::unique_ptr<dynamics::Stepper> make_kinsol_static(dynamics::System& system, dynamics::State& state,
                                                      const IntegratorSpec& spec,
                                                      std::unique_ptr<dynamics::LinearSolver> solver) {
  return std::make_unique<sun::KinsolStatic>(system, state, spec, std::move(solver));
}

}  // namespace palpate::integrate
