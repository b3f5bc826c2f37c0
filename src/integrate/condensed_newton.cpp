#include "integrate/condensed_newton.h"

#include <algorithm>
#include <cmath>

#include "core/clock.h"

namespace palpate::integrate {

using dynamics::Block;
using dynamics::BorderedMatrix;
using dynamics::Layout;
using dynamics::SolveStatus;

void CondensedNewton::evaluate(const dynamics::StateView& state, dynamics::StepperCounters& counters,
                               const dynamics::System::TermFilter& filter) {
  counters_ = &counters;
  filter_ = filter;
  layout_ = state.layout;
  time_ = state.time;
  q_ = state.q;
  u_ = state.u;
  evaluate_matrices();
}

void CondensedNewton::evaluate_matrices() {
  const ScopedTimer timer(counters_->tangent_s);
  ++counters_->tangent_evaluations;
  const dynamics::StateView state = dynamics::make_view(*layout_, time_, q_.data(), u_.data());
  system_.step_matrix(state, 1.0, 0.0, 0.0, M_);
  system_.step_matrix(state, 0.0, 1.0, 0.0, D_, filter_);
  system_.step_matrix(state, 0.0, 0.0, 1.0, K_, filter_);
  gamma_ = 0.0;
}

// M, D and K have the identity in driven rows. Their combination holds 1 + gamma + gamma^2 there, which is
// positive, as required.
void CondensedNewton::combine(double gamma) {
  if (A_.body.pattern_version() != M_.body.pattern_version() || A_.border_size() != M_.border_size()) A_ = M_;
  const auto map = [](const BorderedMatrix& B) {
    return Eigen::Map<const Eigen::ArrayXd>(B.body.values().data(),
                                            static_cast<Eigen::Index>(B.body.values().size()));
  };
  Eigen::Map<Eigen::ArrayXd>(A_.body.values().data(), static_cast<Eigen::Index>(A_.body.values().size())) =
      map(M_) + gamma * map(D_) + (gamma * gamma) * map(K_);
  A_.right = M_.right + gamma * D_.right + (gamma * gamma) * K_.right;
  A_.bottom = M_.bottom + gamma * D_.bottom + (gamma * gamma) * K_.bottom;
  A_.corner = M_.corner + gamma * D_.corner + (gamma * gamma) * K_.corner;
  A_.symmetric = M_.symmetric && D_.symmetric && K_.symmetric;
  A_.positions = M_.positions;
  A_.touch();
}

SolveStatus CondensedNewton::factor(double gamma) {
  if (gamma == gamma_) return SolveStatus::kOk;
  combine(gamma);
  const SolveStatus status = solver_.factor(A_, system_, [&] {
    evaluate_matrices();
    combine(gamma);
  });
  gamma_ = status == SolveStatus::kOk ? gamma : 0.0;
  return status;
}

// A = M + gamma D + gamma^2 K is at least M where tangents are not negative, and a consistent mass at least
// half its diagonal (for a tetrahedron: 1/20 (I + 1 1^T) over 1/10, eigenvalues from 1/2). So with masses m
//     e . A e >= c sum m_i e_i^2,    c = 1, or 1/2 where masses are not lumped,
//     mean (w e)^2 = 1/n sum (w_u,i^2 + gamma^2 w_q,i^2) e_i^2 <= 1/(c n) max_i ((..)/m_i)  e . A e,
// and |e|_A <= error sqrt(c n / max) keeps the weighted norm below `error`. The maximum is attained at the
// lightest node, and elastic components of e have more energy than their mass alone accounts for: the bound
// is met with a margin.
void CondensedNewton::limit_error(const Layout& layout, const double* w, double error) {
  double largest = 0.0;
  for (int i = 0; i < layout.nodal_size; ++i) {
    if (system_.driven_mask()[static_cast<std::size_t>(i)]) continue;
    const double wq = gamma_ * w[i], wu = w[layout.q_size + i],
                 m = M_.body.block(M_.body.diagonal(i / 3))[4 * (i % 3)];
    if (!(m > 0.0)) return tolerance_->allow_error(0.0);  // No bound.
    largest = std::max(largest, (wq * wq + wu * wu) / m);
  }
  double c = 1.0;
  for (const auto& inertia : system_.inertias())
    if (!inertia->diagonal()) c = 0.5;
  const double n = layout.q_size + layout.u_size;
  tolerance_->allow_error(largest > 0.0 ? error * std::sqrt(c * n / largest) : 0.0);
}

/// Solves for du_. right_hand_side() writes rhs_ from the matrices M, D and K that are current when it is
/// called.
template <class RightHandSide>
SolveStatus CondensedNewton::solve_for(RightHandSide&& right_hand_side) {
  const double gamma = gamma_;
  const auto reassemble = [&] {
    evaluate_matrices();
    combine(gamma);
  };
  const auto written = [&]() -> const VecX& {
    right_hand_side();
    return rhs_;
  };
  const SolveStatus status = solver_.solve(system_, reassemble, written, du_);
  gamma_ = status == SolveStatus::kOk ? gamma : 0.0;
  return status;
}

/// Computes theta = N+ r1; zero along driven directions, and with nodes_only on blocks with kinematics.
void CondensedNewton::left_inverse(const Layout& layout, const double* q, const double* r1, bool nodes_only) {
  theta_.resize(layout.u_size);
  for (const Block& b : layout.blocks) {
    const Eigen::Map<const VecX> r(r1 + b.q_offset, b.q_size);
    if (!b.kinematics)
      theta_.segment(b.u_offset, b.u_size) = r;
    else if (nodes_only)
      theta_.segment(b.u_offset, b.u_size).setZero();
    else
      b.kinematics->u_of_q_dot(Eigen::Map<const VecX>(q + b.q_offset, b.q_size), r,
                               theta_.segment(b.u_offset, b.u_size));
  }
  for (int dof : system_.driven_dofs()) theta_[dof] = 0.0;
}

SolveStatus CondensedNewton::solve(const Layout& layout, const double* q, const double* r1, const double* r2,
                                   double* dq, double* du, bool nodes_only) {
  left_inverse(layout, q, r1, nodes_only);
  const double gamma = gamma_;
  const auto right_hand_side = [&] {
    free_r2_ = Eigen::Map<const VecX>(r2, layout.u_size);
    for (int dof : system_.driven_dofs()) free_r2_[dof] = 0.0;
    M_.multiply(free_r2_, rhs_);
    K_.multiply(theta_, product_);
    rhs_ -= gamma * product_;
  };
  if (const SolveStatus status = solve_for(right_hand_side); status != SolveStatus::kOk) return status;

  dynamics::q_dot(layout, q, du_.data(), dq);
  Eigen::Map<VecX> dq_map(dq, layout.q_size);
  if (nodes_only)
    for (const Block& b : layout.blocks)
      if (b.kinematics) dq_map.segment(b.q_offset, b.q_size).setZero();
  dq_map = gamma_ * dq_map + Eigen::Map<const VecX>(r1, layout.q_size);
  Eigen::Map<VecX>(du, layout.u_size) = du_;
  for (int dof : system_.driven_dofs()) {
    dq[dof] = r1[dof];
    du[dof] = r2[dof];
  }
  return SolveStatus::kOk;
}

SolveStatus CondensedNewton::solve_residual_form(const Layout& layout, const double* q, const double* r1,
                                                 const double* r2, double* dq, double* du) {
  left_inverse(layout, q, r1, false);
  const double gamma = gamma_;
  const auto right_hand_side = [&] {
    K_.multiply(theta_, product_);
    rhs_ = gamma * (Eigen::Map<const VecX>(r2, layout.u_size) - gamma * product_);
    for (int dof : system_.driven_dofs()) rhs_[dof] = 0.0;
  };
  if (const SolveStatus status = solve_for(right_hand_side); status != SolveStatus::kOk) return status;

  dynamics::q_dot(layout, q, du_.data(), dq);
  Eigen::Map<VecX> dq_map(dq, layout.q_size);
  dq_map = gamma_ * (dq_map + Eigen::Map<const VecX>(r1, layout.q_size));
  Eigen::Map<VecX>(du, layout.u_size) = du_;
  for (int dof : system_.driven_dofs()) {
    dq[dof] = gamma_ * r1[dof];
    du[dof] = gamma_ * r2[dof];
  }
  return SolveStatus::kOk;
}

}  // namespace palpate::integrate
