#include "palpate/dynamics/step_assembly.h"

#include <algorithm>
#include <cmath>

namespace palpate::dynamics {

void StepAssembly::find_parts() {
  parts_.clear();
  all_can_ = true;
  for (const auto& term : system_.terms()) {
    FusedStepTerm* fused = term->traits().zero_tangent ? nullptr : dynamic_cast<FusedStepTerm*>(term.get());
    all_can_ = all_can_ && (fused || term->traits().zero_tangent);
    parts_.push_back({term.get(), fused});
  }
  pattern_version_ = 0;
}

/// Between different nodes no pair is in the pattern of two terms, nor in that of a mass.
bool StepAssembly::pairs_are_disjoint() const {
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const NodePairs& own = system_.node_pairs(i);
    pairs +=
        own.size() - static_cast<std::size_t>(std::count_if(
                         own.begin(), own.end(), [](const auto& pair) { return pair.first == pair.second; }));
  }
  // fewer in all: some are shared; more: a mass has some
  const BlockSparse& pattern = system_.pattern();
  return pairs == static_cast<std::size_t>(pattern.slot_count() - pattern.block_rows());
}

bool StepAssembly::applies(const StateView& state) {
  const Layout& layout = *state.layout;
  if (layout.border_size() > 0 || layout.nodal_size == 0 || system_.nodal_mass().size() != layout.nodal_size)
    return false;
  if (parts_.size() != system_.terms().size()) find_parts();
  if (!all_can_) return false;
  for (const Part& part : parts_)
    if (part.fused && !part.fused->fuses_step()) return false;
  if (const std::uint64_t version = system_.updated_pattern(state).pattern_version();
      version != pattern_version_) {
    disjoint_ = pairs_are_disjoint();
    pattern_version_ = version;
  }
  return disjoint_;
}

void StepAssembly::assemble(const StateView& state, const VecX& shift, double m_scale, double d_scale,
                            double k_scale, VecX& f, ZeroRowSumMatrix& A) {
  f.setZero(state.layout->u_size);
  A.scale = std::ldexp(1.0, -std::ilogb(system_.mean_nodal_mass()));
  A.diagonal = m_scale * system_.nodal_mass();
  A.positions = state.q.data();  // node blocks come first, with q' = u
  A.held = &system_.driven_nodes();
  for (const Part& part : parts_) {
    if (part.fused)
      part.fused->add_step(state, shift, k_scale, d_scale, f, A);
    else
      part.term->add_force(state, f);
  }
}

void StepAssembly::residual(const StateView& state, const VecX& shift, const VecX& change, double h,
                            VecX& r) {
  r.setZero(state.layout->u_size);
  for (const Part& part : parts_) {
    if (part.fused)
      part.fused->add_step_force(state, shift, change, r);
    else
      part.term->add_force(state, r);
  }
  r = h * r - system_.nodal_mass().cwiseProduct(change);
  for (int dof : system_.driven_dofs()) r[dof] = 0.0;
}

}  // namespace palpate::dynamics
