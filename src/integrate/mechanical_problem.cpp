#include "integrate/mechanical_problem.h"

#include <algorithm>

#include "core/clock.h"
#include "core/finite.h"
#include "integrate/error_weights.h"

namespace palpate::integrate {

using dynamics::Block;
using dynamics::Layout;
using dynamics::SolveStatus;
using dynamics::StateView;
using dynamics::TermTraits;

MechanicalProblem::MechanicalProblem(dynamics::System& system, dynamics::State& state,
                                     const IntegratorSpec& spec,
                                     std::unique_ptr<dynamics::LinearSolver> solver)
    : system_(system), state_(state), spec_(spec), clamped_before_(system.clamped_tangents()) {
  if (solver) newton_ = std::make_unique<CondensedNewton>(system, std::move(solver), spec);
}

StateView MechanicalProblem::view(double t, const double* y) {
  const Layout& l = layout();
  if (!system_.any_driven()) return state_.view(t, y, y + l.q_size);
  imposed_ = Eigen::Map<const VecX>(y, size());
  system_.impose(l, t, imposed_.data(), imposed_.data() + l.q_size);
  return state_.view(t, imposed_.data(), imposed_.data() + l.q_size);
}

dynamics::System::TermFilter MechanicalProblem::filter(Side side) const {
  const bool contact_explicit = spec_.explicit_side == ExplicitSide::kContact;
  const auto is_implicit = [contact_explicit](const TermTraits& t) {
    return t.stiff && !(t.contact && contact_explicit);
  };
  const auto is_fast = [](const TermTraits& t) { return t.fast || t.contact; };
  switch (side) {
    case Side::kAll: return {};
    case Side::kImplicit: return is_implicit;
    case Side::kExplicit: return [is_implicit](const TermTraits& t) { return !is_implicit(t); };
    case Side::kSlow: return [is_fast](const TermTraits& t) { return !is_fast(t); };
    case Side::kFast: return is_fast;
  }
  return {};
}

void MechanicalProblem::rates(Side side, const StateView& at, double* q_dot) const {
  const Layout& l = layout();
  if (side == Side::kExplicit) {
    Eigen::Map<VecX>(q_dot, l.q_size).setZero();
    return;
  }
  dynamics::q_dot(l, at.q.data(), at.u.data(), q_dot);
  if (side != Side::kSlow && side != Side::kFast) return;
  for (const Block& b : l.blocks)
    if ((b.kinematics != nullptr) != (side == Side::kFast))
      Eigen::Map<VecX>(q_dot + b.q_offset, b.q_size).setZero();
}

bool MechanicalProblem::derivative(double t, const double* y, double* y_dot, Side side) {
  const Layout& l = layout();
  {
    const ScopedTimer timer(counters_.force_s);
    if (side != Side::kExplicit && side != Side::kFast) ++counters_.force_evaluations;
    const StateView at = view(t, y);
    system_.force(at, force_, filter(side));
    if (!all_finite(force_)) return false;
    system_.acceleration_of_force(at, force_, acceleration_);
    // The inertia of driven directions belongs to the other side.
    if ((side == Side::kExplicit || side == Side::kFast) && system_.any_driven()) {
      force_.setZero(l.u_size);
      system_.acceleration_of_force(at, force_, driven_part_);
      acceleration_ -= driven_part_;
    }
    rates(side, at, y_dot);
  }
  Eigen::Map<VecX>(y_dot + l.q_size, l.u_size) = acceleration_;
  // Node blocks come first: one index is valid in both.
  for (int dof : system_.driven_dofs()) y_dot[dof] = y_dot[l.q_size + dof] = 0.0;
  return all_finite(Eigen::Map<const VecX>(y_dot, size()));
}

void MechanicalProblem::evaluate_tangent(double t, const double* y, Side side) {
  tangent_side_ = side;
  newton_->evaluate(view(t, y), counters_, filter(side));
}

SolveStatus MechanicalProblem::solve(const double* y, const double* r, double* d) {
  const int nq = layout().q_size;
  return newton_->solve(layout(), y, r, r + nq, d, d + nq, tangent_side_ == Side::kSlow);
}

// F1 = q' - N(q) u and F2 = M u' - f on free directions; q' and u' on driven ones.
bool MechanicalProblem::residual(double t, const double* y, const double* y_dot, double* r) {
  const Layout& l = layout();
  {
    const ScopedTimer timer(counters_.force_s);
    ++counters_.force_evaluations;
    const StateView at = view(t, y);
    acceleration_ = Eigen::Map<const VecX>(y_dot + l.q_size, l.u_size);
    system_.residual(at, acceleration_, force_);
    dynamics::q_dot(l, at.q.data(), at.u.data(), r);
  }
  Eigen::Map<VecX>(r, l.q_size) =
      Eigen::Map<const VecX>(y_dot, l.q_size) - Eigen::Map<const VecX>(r, l.q_size);
  Eigen::Map<VecX>(r + l.q_size, l.u_size) = force_;
  for (int dof : system_.driven_dofs()) {
    r[dof] = y_dot[dof];
    r[l.q_size + dof] = y_dot[l.q_size + dof];
  }
  return all_finite(Eigen::Map<const VecX>(r, size()));
}

SolveStatus MechanicalProblem::solve_residual(const double* y, const double* r, double* d) {
  const int nq = layout().q_size;
  return newton_->solve_residual_form(layout(), y, r, r + nq, d, d + nq);
}

void MechanicalProblem::events(double t, const double* y, double* g) { system_.events(view(t, y), g); }

int MechanicalProblem::dof_of(int i) const {
  const Layout& l = layout();
  if (i >= l.q_size) return i - l.q_size;
  for (const Block& b : l.blocks)
    if (i >= b.q_offset && i < b.q_offset + b.q_size)
      return b.u_offset + (b.kinematics ? std::min(i - b.q_offset, b.u_size - 1) : i - b.q_offset);
  return -1;
}

std::pair<dynamics::Diagnostic, std::string> MechanicalProblem::inspect(double t, const double* y) {
  return system_.inspect(view(t, y));
}

bool MechanicalProblem::has_manifold() const {
  const auto& blocks = layout().blocks;
  return std::any_of(blocks.begin(), blocks.end(), [](const Block& b) { return b.kinematics != nullptr; });
}

void MechanicalProblem::weights(const double* y, double* w) const {
  error_weights(layout(), spec_, system_.driven_mask(), y + layout().q_size, w);
}

void MechanicalProblem::load(double* y) const {
  const Layout& l = layout();
  Eigen::Map<VecX>(y, l.q_size) = state_.q();
  Eigen::Map<VecX>(y + l.q_size, l.u_size) = state_.u();
}

void MechanicalProblem::store(double t, const double* y) {
  const Layout& l = layout();
  state_.q() = Eigen::Map<const VecX>(y, l.q_size);
  state_.u() = Eigen::Map<const VecX>(y + l.q_size, l.u_size);
  state_.set_time(t);
  dynamics::project(l, state_.q().data());
  system_.impose(l, t, state_.q().data(), state_.u().data());
}

void MechanicalProblem::finish(double t, const double* y, VecX& q, VecX& u) const {
  const Layout& l = layout();
  q = Eigen::Map<const VecX>(y, l.q_size);
  u = Eigen::Map<const VecX>(y + l.q_size, l.u_size);
  dynamics::project(l, q.data());
  system_.impose(l, t, q.data(), u.data());
}

void MechanicalProblem::collect_solver_counters() {
  counters_.clamped = system_.clamped_tangents() - clamped_before_;
  if (!newton_) return;
  newton_->solver().report(counters_);
}

}  // namespace palpate::integrate
