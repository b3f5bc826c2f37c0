#include "palpate/dynamics/step_assembly.h"

#include <algorithm>
#include <cmath>

namespace palpate::dynamics {

void StepAssembly::find_parts() {
  parts_.clear();
  all_can_ = true;
  any_beside_ = false;
  for (const auto& term : system_.terms()) {
    const bool zero = term->traits().zero_tangent;
    FusedStepTerm* fused = zero ? nullptr : dynamic_cast<FusedStepTerm*>(term.get());
    PointStiffnessTerm* beside = zero || fused ? nullptr : dynamic_cast<PointStiffnessTerm*>(term.get());
    all_can_ = all_can_ && (fused || beside || zero);
    any_beside_ = any_beside_ || beside;
    parts_.push_back({term.get(), fused, beside});
  }
  made_of_.clear();
  pattern_version_ = 0;
}

namespace {

/// Whether, between different nodes, no pair is in two of these lists, nor in that of a mass: fewer in all,
/// and some are shared; more, and a mass has some.
bool are_disjoint(const std::vector<const NodePairs*>& lists, const BlockSparse& pattern) {
  std::size_t pairs = 0;
  for (const NodePairs* own : lists)
    pairs += own->size() - static_cast<std::size_t>(std::count_if(
                               own->begin(), own->end(), [](const auto& p) { return p.first == p.second; }));
  return pairs == static_cast<std::size_t>(pattern.slot_count() - pattern.block_rows());
}

}  // namespace

/// The pattern of the fused terms alone.
void StepAssembly::update_own_pattern(const Layout& layout) {
  versions_.assign(1, layout.version);
  for (const Part& part : parts_)
    if (part.fused) versions_.push_back(part.term->pattern_version());
  if (versions_ == made_of_) return;
  made_of_ = versions_;
  std::vector<NodePairs> pairs;
  for (const Part& part : parts_) {
    if (!part.fused) continue;
    PatternBuilder builder(layout);
    part.term->add_pattern(builder);
    pairs.push_back(builder.pairs());
  }
  std::vector<const NodePairs*> lists;
  for (const NodePairs& own : pairs) lists.push_back(&own);
  pattern_ = pattern_of(layout.node_count(), lists);
  disjoint_ = are_disjoint(lists, pattern_);
}

bool StepAssembly::applies(const StateView& state) {
  const Layout& layout = *state.layout;
  if (layout.border_size() > 0 || layout.nodal_size == 0 || system_.nodal_mass().size() != layout.nodal_size)
    return false;
  if (parts_.size() != system_.terms().size()) find_parts();
  if (!all_can_) return false;
  for (const Part& part : parts_)
    if ((part.fused && !part.fused->fuses_step()) || (part.beside && !part.beside->is_point_stiffness()))
      return false;
  if (any_beside_) {
    update_own_pattern(layout);
  } else if (const std::uint64_t version = system_.updated_pattern(state).pattern_version();
             version != pattern_version_) {
    std::vector<const NodePairs*> lists;
    for (std::size_t i = 0; i < parts_.size(); ++i) lists.push_back(&system_.node_pairs(i));
    disjoint_ = are_disjoint(lists, system_.pattern());
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
  A.points.clear();
  for (const Part& part : parts_) {
    if (part.fused)
      part.fused->add_step(state, shift, k_scale, d_scale, f, A);
    else if (part.beside)
      part.beside->add_step(state, shift, k_scale, d_scale, f, A.points);
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
    else if (part.beside)
      part.beside->add_step_force(state, shift, change, r);
    else
      part.term->add_force(state, r);
  }
  r = h * r - system_.nodal_mass().cwiseProduct(change);
  for (int dof : system_.driven_dofs()) r[dof] = 0.0;
}

}  // namespace palpate::dynamics
