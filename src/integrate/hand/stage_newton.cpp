#include "integrate/hand/stage_newton.h"

#include <cmath>

#include "integrate/error_weights.h"
#include "integrate/hand/displace.h"
#include "palpate/core/clock.h"

namespace palpate::integrate {

using dynamics::SolveStatus;
using dynamics::StateView;
using dynamics::StepStatus;

namespace {

constexpr int kIterations = 20, kDefiniteIterations = 60;
constexpr double kSlow = 0.5;             // contraction above which an old matrix is renewed
constexpr double kSmallestDamping = 1.0 / 64.0;
constexpr double kOtherCoefficients = 0.1;
constexpr double kRounding = 1e-14;

/// Bound of what is left after a correction of this size at this contraction (geometric series), at least the correction itself.
double left_over(double correction, double contraction) {
  return correction * std::max(1.0, contraction < 0.95 ? contraction / (1.0 - contraction) : 20.0);
}

}  // namespace

StageNewton::StageNewton(dynamics::System& system, const IntegratorSpec& spec, std::unique_ptr<dynamics::LinearSolver> solver)
    : system_(system), tolerance_(spec), kept_steps_(spec.factor_kept_steps), solver_(std::move(solver), spec) {
  tolerance_.rtol = spec.newton_rtol;
}

NewtonResult StageNewton::solve(const Stage& stage, const StateView& from, VecX& a, VecX& q1, VecX& u1, dynamics::StepperCounters& counters) {
  stage_ = &stage;
  from_ = &from;
  counters_ = &counters;
  a_ = &a;
  q1_ = &q1;
  u1_ = &u1;
  const dynamics::Layout& layout = *from.layout;
  q1.resize(layout.q_size);
  u1.resize(layout.u_size);
  weights_.resize(layout.q_size + layout.u_size);
  error_weights(layout, tolerance_, system_.driven_mask(), from.u.data(), weights_.data());

  NewtonResult result = iterate(kIterations, kept_steps_ == 1);
  if (result.status == StepStatus::kOk) return result;
  a = stage.theta / -stage.c_theta;
  for (int dof : system_.driven_dofs()) a[dof] = 0.0;
  NewtonResult second;
  {
    const DefiniteTangents definite(system_);
    second = iterate(kDefiniteIterations, true);
  }
  forget();  // the next step wants the true tangent
  second.iterations += result.iterations;
  return second;
}

/// q1, u1, theta of an iterate; false where they are not finite.
bool StageNewton::place(const VecX& a) {
  const dynamics::Layout& layout = *from_->layout;
  *u1_ = stage_->u + stage_->c_u * a;
  theta_ = stage_->theta + stage_->c_theta * a;
  if (!displace(layout, from_->q.data(), theta_.data(), q1_->data(), scratch_)) return false;
  system_.impose(layout, stage_->t1, q1_->data(), u1_->data());
  return q1_->allFinite() && u1_->allFinite();
}

bool StageNewton::evaluate(const VecX& a) {
  if (!place(a)) return false;
  const double w = stage_->weight;
  if (w != 1.0) {
    q_s_ = w * *q1_ + (1.0 - w) * from_->q;
    u_s_ = w * *u1_ + (1.0 - w) * from_->u;
  }
  a_s_ = stage_->c_a * a;
  if (stage_->a_c.size() > 0) a_s_ += stage_->a_c;
  const ScopedTimer timer(counters_->force_s);
  ++counters_->force_evaluations;
  system_.residual(at(), a_s_, residual_);
  return residual_.allFinite();
}

/// The stage of the iterate last evaluated.
StateView StageNewton::at() const {
  const double w = stage_->weight;
  if (w == 1.0) return dynamics::make_view(*from_->layout, stage_->t1, q1_->data(), u1_->data());
  return dynamics::make_view(*from_->layout, w * stage_->t1 + (1.0 - w) * from_->time, q_s_.data(), u_s_.data());
}

bool StageNewton::usable() const {
  const auto near = [](double now, double then) { return std::abs(now - then) <= kOtherCoefficients * std::abs(then); };
  return have_factor_ && age_ < kept_steps_ && near(stage_->c_a, m_scale_) && near(stage_->weight * stage_->c_u, d_scale_) &&
         near(stage_->weight * stage_->c_theta, k_scale_);
}

/// The matrix of the iterate last evaluated, factored.
SolveStatus StageNewton::refresh() {
  m_scale_ = stage_->c_a;
  d_scale_ = stage_->weight * stage_->c_u;
  k_scale_ = stage_->weight * stage_->c_theta;
  const auto assemble = [this] {
    const ScopedTimer timer(counters_->tangent_s);
    ++counters_->tangent_evaluations;
    system_.step_matrix(at(), m_scale_, d_scale_, k_scale_, A_);
  };
  assemble();
  const SolveStatus status = solver_.factor(A_, system_, assemble);
  have_factor_ = status == SolveStatus::kOk;
  age_ = 0;
  contraction_ = 0.0;
  return status;
}

/// Of the increments of q and u that an increment d of the unknown makes.
double StageNewton::norm(const VecX& d) {
  const dynamics::Layout& layout = *from_->layout;
  dq_.resize(layout.q_size);
  dynamics::q_dot(layout, q1_->data(), d.data(), dq_.data());
  const double q_part = (stage_->c_theta * dq_.cwiseProduct(weights_.head(layout.q_size))).squaredNorm();
  const double u_part = (stage_->c_u * d.cwiseProduct(weights_.tail(layout.u_size))).squaredNorm();
  return std::sqrt((q_part + u_part) / static_cast<double>(weights_.size()));
}

/// d = -A^-1 r with its norm; false where it is none.
bool StageNewton::correct(VecX& d, double& size) {
  if (solver_.solve(residual_, d) != SolveStatus::kOk || !d.allFinite()) return false;
  d = -d;
  size = norm(d);
  return std::isfinite(size);
}

/// A correction that is rounding of the unknown itself cannot be made smaller.
bool StageNewton::converged(double correction, double contraction) {
  return left_over(correction, contraction) <= 1.0 || correction <= kRounding * norm(*a_);
}

NewtonResult StageNewton::finish(int iterations, double correction) {
  if (!place(*a_)) return {StepStatus::kNotFinite, iterations, correction, "the position or the velocity is not finite"};
  dynamics::project(*from_->layout, q1_->data());
  system_.impose(*from_->layout, stage_->t1, q1_->data(), u1_->data());
  return {StepStatus::kOk, iterations, correction, ""};
}

NewtonResult StageNewton::iterate(int limit, bool full) {
  const auto failed = [](StepStatus status, int iterations, double correction, const char* what) { return NewtonResult{status, iterations, correction, what}; };
  VecX& a = *a_;
  if (!evaluate(a)) return failed(StepStatus::kNotFinite, 0, 0.0, "the force is not finite");
  if ((residual_.array() == 0.0).all()) return finish(0, 0.0);
  bool fresh = full || !usable();
  double size = 0.0;
  if ((fresh && refresh() != SolveStatus::kOk) || !correct(d_, size))
    return failed(StepStatus::kSolverFailed, 0, 0.0, "the step matrix is singular or not finite");
  for (int k = 1; k <= limit; ++k) {
    if (converged(size, contraction_)) {
      a += d_;
      return finish(k, size);
    }
    double lambda = 1.0, next = 0.0, kappa = 0.0;
    bool taken = false;
    for (; !taken && lambda >= kSmallestDamping; lambda /= 2.0) {
      trial_ = a + lambda * d_;
      if (evaluate(trial_)) {
        if (!correct(e_, next)) return failed(StepStatus::kSolverFailed, k, size, "the step matrix is singular or not finite");
        kappa = next / size;
        taken = next <= 1.0 || next <= kRounding * norm(trial_) || kappa <= 1.0 - lambda / 4.0;
      }
      if (!taken && !fresh) break;
    }
    if (!taken && fresh) return failed(StepStatus::kNewtonFailed, k, size, "Newton finds no descent");
    if (taken) {
      a = trial_;
      contraction_ = kappa;
      if (converged(next, kappa)) {
        a += e_;
        return finish(k, next);
      }
    } else if (!evaluate(a)) {  // the old matrix led astray: back
      return failed(StepStatus::kNotFinite, k, size, "the force is not finite");
    }
    if (full || !taken || kappa > kSlow) {
      fresh = true;
      const double kept = taken ? kappa : 0.0;
      if (refresh() != SolveStatus::kOk || !correct(d_, size)) return failed(StepStatus::kSolverFailed, k, next, "the step matrix is singular or not finite");
      contraction_ = kept;  // what a fresh matrix does is seen after its first correction
    } else {
      fresh = false;
      d_.swap(e_);
      size = next;
    }
  }
  return failed(StepStatus::kNewtonFailed, limit, size, "Newton did not converge");
}

}  // namespace palpate::integrate
