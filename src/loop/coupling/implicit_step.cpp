#include "implicit_step.h"

#include "core/counters.h"
#include "palpate/linear/solvers.h"

namespace palpate::loop {

dynamics::LinearSolver* StepFactor::of(dynamics::System& system, const dynamics::StateView& state, double H) {
  system.step_matrix(state, 1.0, H, H * H, matrix_);
  if (!symmetric_) {
    counters::count("loop.condenser");
    symmetric_ = linear::make_linear_solver(system.symmetric() ? "cholmod" : "umfpack");
  }
  const dynamics::SolveStatus status = symmetric_->factor(matrix_);
  if (status == dynamics::SolveStatus::kOk) return symmetric_.get();
  if (status != dynamics::SolveStatus::kIndefinite) return nullptr;
  counters::count("loop.condensed_by_lu");
  if (!lu_) lu_ = linear::make_linear_solver("umfpack");
  return lu_->factor(matrix_) == dynamics::SolveStatus::kOk ? lu_.get() : nullptr;
}

VecX moved(const dynamics::State& state, const VecX& displacement) {
  VecX rate(state.q().size());
  dynamics::q_dot(state.layout(), state.q().data(), displacement.data(), rate.data());
  VecX q = state.q() + rate;
  dynamics::project(state.layout(), q.data());
  return q;
}

void known_motion(const dynamics::System& system, const dynamics::State& state, double H, VecX& s, VecX& w) {
  const VecX q0 = state.q(), u0 = state.u();
  VecX q = moved(state, H * u0), u = u0;
  s = H * u0;
  w = VecX::Zero(u0.size());
  system.impose(state.layout(), state.time() + H, q.data(), u.data());
  for (int dof : system.driven_dofs()) {
    s[dof] = q[dof] - q0[dof];
    w[dof] = u[dof] - u0[dof];
  }
}

// Another tool continues with its twist v, and the implicit step uses its position at the end, H later:
//     f1 = ... - K_no H v,     so that H f gains H^2 rate with rate = -K_no v.
VecX rate_by_other_tools(const CoupledTool& tool) {
  VecX rate;
  for (const auto& [frame, twist] : tool.others) {
    contact::FrameLinearisation c;
    tool.contact.linearise(tool.state.view(), frame, c, contact::Partners::kNodes);
    if (c.active == 0) continue;
    if (rate.size() == 0) rate = VecX::Zero(tool.state.layout().u_size);
    rate.head(c.K_body.rows()) -= c.K_body * stacked(twist);
  }
  return rate;
}

VecX right_hand_side(dynamics::System& system, const dynamics::State& state, double H, const VecX& s,
                     const VecX& w, const VecX& rate) {
  const dynamics::StateView view = state.view();
  VecX f, inertia, stiff = VecX::Zero(s.size());
  system.force(view, f);
  if (rate.size() > 0) f += H * rate;
  for (const auto& term : system.terms()) {
    if (!term->traits().has_tangent) continue;
    term->apply_tangent(view, 1.0, 0.0, s, stiff);
    term->apply_tangent(view, 0.0, 1.0, w, stiff);
  }
  system.apply_mass(view, w, inertia);
  VecX r = H * (f - stiff) - inertia;
  system.reduce(view, r);
  stiff.setZero();
  system.apply_carried_stiffness(view, s, stiff);
  return r - H * stiff;
}

}  // namespace palpate::loop
