#include "integrate/fixed_step/stage_newton.h"

#include <cmath>

#include "core/clock.h"
#include "core/finite.h"
#include "integrate/error_weights.h"
#include "integrate/fixed_step/displace.h"
#include "integrate/tuning.h"

namespace palpate::integrate {

using dynamics::SolveStatus;
using dynamics::StateView;
using dynamics::StepStatus;

namespace {}  // namespace

StageNewton::StageNewton(dynamics::System& system, const IntegratorSpec& spec,
                         std::unique_ptr<dynamics::LinearSolver> solver)
    : system_(system),
      tolerance_(spec),
      kept_steps_(spec.factor_kept_steps),
      solver_(std::move(solver), spec) {
  tolerance_.rtol = spec.newton_rtol;
}

NewtonResult StageNewton::solve(const Stage& stage, const StateView& from, VecX& a, VecX& q1, VecX& u1,
                                dynamics::StepperCounters& counters) {
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

  NewtonResult result = iterate(tuning::kNewtonIterations, kept_steps_ == 1);
  counters.kept_matrix_iterations += result.kept;
  if (result.status == StepStatus::kOk) return result;
  ++counters.definite_retries;
  a = stage.theta / -stage.c_theta;
  for (int dof : system_.driven_dofs()) a[dof] = 0.0;
  NewtonResult second;
  {
    const ProjectedTangents projected(system_);
    second = iterate(tuning::kDefiniteIterations, true);
  }
  forget();  // The next step uses the true tangent.
  second.iterations += result.iterations;
  return second;
}

/// Computes q1, u1 and theta of an iterate; returns false where they are not finite.
bool StageNewton::place(const VecX& a) {
  const dynamics::Layout& layout = *from_->layout;
  *u1_ = stage_->u + stage_->c_u * a;
  theta_ = stage_->theta + stage_->c_theta * a;
  if (!displace(layout, from_->q.data(), theta_.data(), q1_->data(), scratch_)) return false;
  system_.impose(layout, stage_->t1, q1_->data(), u1_->data());
  return all_finite(*q1_) && all_finite(*u1_);
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
  return all_finite(residual_);
}

/// Returns the stage at the iterate last evaluated.
StateView StageNewton::at() const {
  const double w = stage_->weight;
  if (w == 1.0) return dynamics::make_view(*from_->layout, stage_->t1, q1_->data(), u1_->data());
  return dynamics::make_view(*from_->layout, w * stage_->t1 + (1.0 - w) * from_->time, q_s_.data(),
                             u_s_.data());
}

bool StageNewton::usable() const {
  const auto near = [](double now, double then) {
    return std::abs(now - then) <= tuning::kOtherCoefficients * std::abs(then);
  };
  return have_factor_ && age_ < kept_steps_ && near(stage_->c_a, m_scale_) &&
         near(stage_->weight * stage_->c_u, d_scale_) && near(stage_->weight * stage_->c_theta, k_scale_);
}

/// Assembles the matrix at the iterate last evaluated.
void StageNewton::assemble() {
  const ScopedTimer timer(counters_->tangent_s);
  ++counters_->tangent_evaluations;
  system_.step_matrix(at(), m_scale_, d_scale_, k_scale_, A_);
}

SolveStatus StageNewton::refresh() {
  m_scale_ = stage_->c_a;
  d_scale_ = stage_->weight * stage_->c_u;
  k_scale_ = stage_->weight * stage_->c_theta;
  assemble();
  const SolveStatus status = solver_.factor(A_, system_, [this] { assemble(); });
  have_factor_ = status == SolveStatus::kOk;
  age_ = 0;
  return status;
}

/// Returns the weighted norm of the increments of q and u that an increment d of the unknown causes.
double StageNewton::norm(const VecX& d) {
  const dynamics::Layout& layout = *from_->layout;
  dq_.resize(layout.q_size);
  dynamics::q_dot(layout, q1_->data(), d.data(), dq_.data());
  const double q_part = (stage_->c_theta * dq_.cwiseProduct(weights_.head(layout.q_size))).squaredNorm();
  const double u_part = (stage_->c_u * d.cwiseProduct(weights_.tail(layout.u_size))).squaredNorm();
  return std::sqrt((q_part + u_part) / static_cast<double>(weights_.size()));
}

bool StageNewton::correct(VecX& d, double& size) {
  const auto right_hand_side = [this]() -> const VecX& { return residual_; };
  if (solver_.solve(
          system_, [this] { assemble(); }, right_hand_side, d) != SolveStatus::kOk ||
      !all_finite(d))
    return false;
  d = -d;
  size = norm(d);
  return std::isfinite(size);
}

NewtonResult StageNewton::iterate(int limit, bool full) {
  NewtonResult result = newton_.solve(
      *this, *a_, limit, full ? DampedNewton::Way::kFresh : DampedNewton::Way::kKeptMatrix, usable());
  if (result.status != StepStatus::kOk) return result;
  if (!place(*a_))
    return {StepStatus::kNotFinite, result.iterations, result.correction,
            "the position or the velocity is not finite"};
  dynamics::project(*from_->layout, q1_->data());
  system_.impose(*from_->layout, stage_->t1, q1_->data(), u1_->data());
  return result;
}

}  // namespace palpate::integrate
