#include "integrate/first_order.h"

#include "palpate/core/clock.h"

namespace palpate::integrate {

using dynamics::Layout;
using dynamics::StateView;

StateView FirstOrder::view(double t, const double* y) {
  const Layout& l = layout();
  if (!system_.any_driven()) return state_.view(t, y, y + l.q_size);
  imposed_ = Eigen::Map<const VecX>(y, size());
  system_.impose(l, t, imposed_.data(), imposed_.data() + l.q_size);
  return state_.view(t, imposed_.data(), imposed_.data() + l.q_size);
}

bool FirstOrder::derivative(double t, const double* y, double* y_dot, dynamics::StepperCounters& counters) {
  const Layout& l = layout();
  {
    const ScopedTimer timer(counters.force_s);
    ++counters.force_evaluations;
    const StateView at = view(t, y);
    system_.force(at, force_);
    if (!force_.allFinite()) return false;
    system_.acceleration_of_force(at, force_, acceleration_);
    dynamics::q_dot(l, at.q.data(), at.u.data(), y_dot);
  }
  Eigen::Map<VecX>(y_dot + l.q_size, l.u_size) = acceleration_;
  for (int dof : system_.driven_dofs()) y_dot[dof] = y_dot[l.q_size + dof] = 0.0;  // node blocks come first: one index serves both
  return Eigen::Map<const VecX>(y_dot, size()).allFinite();
}

void FirstOrder::load(double* y) const {
  const Layout& l = layout();
  Eigen::Map<VecX>(y, l.q_size) = state_.q();
  Eigen::Map<VecX>(y + l.q_size, l.u_size) = state_.u();
}

void FirstOrder::store(double t, const double* y) {
  const Layout& l = layout();
  state_.q() = Eigen::Map<const VecX>(y, l.q_size);
  state_.u() = Eigen::Map<const VecX>(y + l.q_size, l.u_size);
  state_.set_time(t);
  dynamics::project(l, state_.q().data());
  system_.impose(l, t, state_.q().data(), state_.u().data());
}

void FirstOrder::finish(double t, const double* y, VecX& q, VecX& u) const {
  const Layout& l = layout();
  q = Eigen::Map<const VecX>(y, l.q_size);
  u = Eigen::Map<const VecX>(y + l.q_size, l.u_size);
  dynamics::project(l, q.data());
  system_.impose(l, t, q.data(), u.data());
}

}  // namespace palpate::integrate
