#include "palpate/dynamics/system.h"

#include <algorithm>
#include <cmath>

#include "dynamics/border.h"
#include "palpate/core/error.h"

namespace palpate::dynamics {

void System::add(std::shared_ptr<ForceTerm> term) {
  stored_tangents_.push_back(dynamic_cast<StoredTangentTerm*>(term.get()));
  if (auto* projected = dynamic_cast<PsdProjectedTerm*>(term.get())) projected_terms_.push_back(projected);
  terms_.push_back(std::move(term));
}
void System::add(std::shared_ptr<InertiaTerm> inertia) { inertias_.push_back(std::move(inertia)); }
void System::add(std::shared_ptr<DrivenMotion> motion) {
  driven_.push_back({std::move(motion), -1, 0, {}, {}, {}, {}, {}, {}});
}
void System::set_mass_solver(std::unique_ptr<LinearSolver> solver) { mass_solver_ = std::move(solver); }

bool System::symmetric() const {
  return std::all_of(terms_.begin(), terms_.end(),
                     [](const auto& t) { return t->traits().symmetric_tangent; });
}

void System::project_to_psd(bool on) {
  projects_to_psd_ = on;
  for (PsdProjectedTerm* term : projected_terms_) term->project_to_psd(on);
}

int System::event_count() const {
  int count = 0;
  for (const auto& term : terms_) count += term->event_count();
  return count;
}

std::uint64_t System::events_version() const {
  std::uint64_t sum = terms_.size();  // Versions only increase, and so does their sum.
  for (const auto& term : terms_) sum += term->events_version();
  return sum;
}

void System::events(const StateView& state, double* g) const {
  for (const auto& term : terms_) {
    term->events(state, g);
    g += term->event_count();
  }
}

long System::clamped_tangents() const {
  long sum = 0;
  for (const auto& term : terms_) sum += term->clamped_tangents();
  return sum;
}

std::pair<Diagnostic, std::string> System::inspect(const StateView& state) const {
  for (const auto& term : terms_)
    if (const Diagnostic found = term->inspect(state); found.element >= 0)
      return {found, std::string(term->name())};
  return {};
}

void System::prepare(const StateView& state) {
  const Layout& layout = *state.layout;
  driven_mask_.assign(static_cast<std::size_t>(layout.u_size), 0);
  driven_dofs_.clear();
  any_master_ = false;
  for (Driven& d : driven_) {
    for (int dof : d.motion->dofs()) {
      PALPATE_CHECK(dof >= 0 && dof < layout.nodal_size,
                    "driven direction {} is out of range: there are {} nodal directions", dof,
                    layout.nodal_size);
      if (driven_mask_[static_cast<std::size_t>(dof)]) {
        const Vec3 at = state.position(dof / 3);
        fail("the node at [{:g}, {:g}, {:g}] m is held or driven twice along {}: attachments overlap", at.x(),
             at.y(), at.z(), "xyz"[dof % 3]);
      }
      driven_mask_[static_cast<std::size_t>(dof)] = 1;
      driven_dofs_.push_back(dof);
    }
    d.master_offset = -1;
    if (d.motion->master_block() < 0) continue;
    const Block* master = layout.find(d.motion->master_block());
    PALPATE_CHECK(master && master->kind != BlockKind::kNodes,
                  "driven nodes follow block {}, which is not a rigid block", d.motion->master_block());
    d.master_offset = master->u_offset;
    d.master_size = master->u_size;
    any_master_ = true;
  }
  std::sort(driven_dofs_.begin(), driven_dofs_.end());
  driven_nodes_.clear();
  driven_pattern_ = 0;
  for (int dof : driven_dofs_) {
    if (driven_nodes_.empty() || driven_nodes_.back().node != dof / 3) driven_nodes_.push_back({dof / 3, {}});
    driven_nodes_.back().axes[static_cast<std::size_t>(dof % 3)] = true;
  }

  nodal_mass_diagonal_ = true;
  for (const auto& inertia : inertias_) {
    const Block* block = layout.find(inertia->block_id());
    PALPATE_CHECK(block, "inertia of unknown block {}", inertia->block_id());
    if (block->kind == BlockKind::kNodes && !inertia->diagonal()) nodal_mass_diagonal_ = false;
  }
  assemble_mass(state, mass_);
  mean_nodal_mass_ = 0.0;
  nodal_mass_.resize(nodal_mass_diagonal_ ? layout.nodal_size : 0);
  inverse_nodal_mass_.resize(nodal_mass_.size());
  if (nodal_mass_diagonal_) {
    for (int i = 0; i < layout.nodal_size; ++i) {
      const double m = mass_.body.block(mass_.body.diagonal(i / 3))[4 * (i % 3)];
      PALPATE_CHECK(m > 0.0, "the mass of node {} is {}; it must be positive", i / 3, m);
      nodal_mass_[i] = m;
      inverse_nodal_mass_[i] = 1.0 / m;
    }
    if (layout.nodal_size > 0) mean_nodal_mass_ = nodal_mass_.mean();
  } else {
    PALPATE_CHECK(mass_solver_, "a consistent mass needs a mass solver");
    const SolveStatus status = mass_solver_->factor(mass_);
    PALPATE_CHECK(status == SolveStatus::kOk, "factorisation of the mass matrix failed (status {})",
                  static_cast<int>(status));
  }
}

void System::force(const StateView& state, VecX& f, const TermFilter& filter) {
  f.setZero(state.layout->u_size);
  for (const auto& term : terms_)
    if (!filter || filter(term->traits())) term->add_force(state, f);
}

void System::acceleration(const StateView& state, VecX& a) {
  force(state, force_scratch_);
  acceleration_of_force(state, force_scratch_, a);
}

// With a = P a_free + a_known (prescribed accelerations; G a_master + gamma under a master) and T = d a / d
// (a_free, a_master):
//   T^T M T (a_free, a_master) = T^T (f - M a_known).
void System::acceleration_of_force(const StateView& state, VecX& f, VecX& a) {
  const Layout& layout = *state.layout;
  if (driven_.empty()) return solve_mass(state, f, a);
  evaluate_driven(state);
  known_.setZero(layout.u_size);
  for (const Driven& d : driven_)
    for (std::size_t i = 0; i < d.motion->dofs().size(); ++i)
      known_[d.motion->dofs()[i]] = d.a[static_cast<Eigen::Index>(i)];
  if (!nodal_mass_diagonal_ || any_master_) {
    scratch_.setZero(layout.u_size);
    apply_mass(state, known_, scratch_);
    f -= scratch_;
  }
  reduce(state, f);
  solve_mass(state, f, a);
  for (const Driven& d : driven_) {
    const auto& dofs = d.motion->dofs();
    for (std::size_t i = 0; i < dofs.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      a[dofs[i]] = d.a[row];
      if (d.master_offset >= 0) a[dofs[i]] += d.G.row(row).dot(a.segment(d.master_offset, d.master_size));
    }
  }
}

void System::assemble_mass(const StateView& state, BorderedMatrix& A) {
  const Layout& layout = *state.layout;
  if (mass_layout_ != layout.version) {
    PatternBuilder builder(layout);
    for (const auto& inertia : inertias_) inertia->add_pattern(builder);
    A.body = builder.build();
    mass_layout_ = layout.version;
  }
  resize_border(A, layout.nodal_size, layout.border_size());
  A.set_zero();
  for (const auto& inertia : inertias_) inertia->add_mass(state, 1.0, A);
  if (any_master_) {
    evaluate_driven(state);
    reduce_to_masters(state, A);
  }
  if (!nodal_mass_diagonal_ || any_master_) eliminate_driven(A);
  A.touch();
}

void System::solve_mass(const StateView& state, VecX& r, VecX& a) {
  const Layout& layout = *state.layout;
  const int n = layout.nodal_size, m = layout.border_size();
  a.resize(layout.u_size);
  if (m == 0 && nodal_mass_diagonal_) {
    a = inverse_nodal_mass_.cwiseProduct(r);
    return;
  }
  if (m > 0) assemble_mass(state, mass_);  // a rigid block's mass rotates with it
  if (nodal_mass_diagonal_) {
    a.head(n) = inverse_nodal_mass_.cwiseProduct(r.head(n));
    a.tail(m) = mass_.corner.ldlt().solve(r.tail(m));
    return;
  }
  SolveStatus status = mass_solver_->factor(mass_);
  if (status == SolveStatus::kOk) status = mass_solver_->solve(r, a);
  PALPATE_CHECK(status == SolveStatus::kOk, "factorisation of the mass matrix failed (status {})",
                static_cast<int>(status));
}

/// Computes k_scale K + d_scale D of the terms that pass the filter. A term that writes all rows of a node
/// block does so before any other term adds to them.
void System::assemble_tangents(const StateView& state, double d_scale, double k_scale, BorderedMatrix& A,
                               const TermFilter& filter) {
  const bool any = d_scale != 0.0 || k_scale != 0.0;
  term_is_in_.assign(terms_.size(), 0);
  const auto is_missing = [&](std::size_t i) {
    return any && !term_is_in_[i] && terms_[i]->traits().has_tangent &&
           (!filter || filter(terms_[i]->traits()));
  };
  for (const Block& block : state.layout->blocks) {
    if (block.kind != BlockKind::kNodes) continue;
    std::size_t i = 0;
    const auto stores = [&](std::size_t term) {
      return stored_tangents_[term] && stored_tangents_[term]->stored_block() == block.id && is_missing(term);
    };
    while (i < terms_.size() && !stores(i)) ++i;
    if (i < terms_.size()) {
      stored_tangents_[i]->store_tangent(state, k_scale, d_scale, A);
      term_is_in_[i] = 1;
    } else {
      A.body.set_zero(block.u_offset / 3, block.u_size / 3);
    }
  }
  for (MatX* border : {&A.right, &A.bottom, &A.corner}) border->setZero();
  for (std::size_t i = 0; i < terms_.size(); ++i)
    if (is_missing(i)) terms_[i]->add_tangent(state, k_scale, d_scale, A);
}

void System::step_matrix(const StateView& state, double m_scale, double d_scale, double k_scale,
                         BorderedMatrix& A, const TermFilter& filter) {
  ensure_pattern(state, A);
  assemble_tangents(state, d_scale, k_scale, A, filter);
  A.positions = state.q.head(state.layout->nodal_size);  // node blocks come first, with q' = u
  A.symmetric = symmetric();
  if (m_scale != 0.0)
    for (const auto& inertia : inertias_) inertia->add_mass(state, m_scale, A);
  if (any_master_) {
    if (k_scale != 0.0) {
      evaluate_carried_stiffness(state, filter);
      for (const Driven& d : driven_) {
        if (d.master_offset < 0) continue;
        const int at = d.master_offset - state.layout->nodal_size;
        auto corner = A.corner.block(at, at, d.master_size, d.master_size);
        corner += A.symmetric ? MatX(0.5 * k_scale * (d.K + d.K.transpose())) : MatX(k_scale * d.K);
      }
    }
    evaluate_driven(state);
    reduce_to_masters(state, A);
  }
  eliminate_driven(A);
  A.touch();
}

void System::apply_mass(const StateView& state, const VecX& x, VecX& y) const {
  y.setZero(state.layout->u_size);
  for (const auto& inertia : inertias_) inertia->apply(state, x, y);
}

void System::residual(const StateView& state, const VecX& acceleration, VecX& r) {
  known_ = acceleration;
  evaluate_driven(state);
  for (const Driven& d : driven_)
    for (std::size_t i = 0; i < d.motion->dofs().size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      double& a = known_[d.motion->dofs()[i]];
      a = d.a[row];
      if (d.master_offset >= 0) a += d.G.row(row).dot(acceleration.segment(d.master_offset, d.master_size));
    }
  apply_mass(state, known_, r);
  force(state, force_scratch_);
  r -= force_scratch_;
  reduce(state, r);
}

double System::kinetic_energy(const StateView& state) const {
  VecX momentum;
  apply_mass(state, VecX(state.u), momentum);
  return 0.5 * momentum.dot(state.u);
}

double System::potential_energy(const StateView& state) {
  double sum = 0.0;
  for (const auto& term : terms_) sum += term->energy(state);
  return sum;
}

}  // namespace palpate::dynamics
