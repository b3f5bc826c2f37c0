#include "palpate/dynamics/step_assembly.h"

#include <algorithm>
#include <cmath>

#include "core/counters.h"
#include "palpate/core/error.h"

namespace palpate::dynamics {

void StepAssembly::find_parts() {
  parts_.clear();
  all_can_ = true;
  any_beside_ = false;
  for (const auto& term : system_.terms()) {
    CornerTerm* const corner = dynamic_cast<CornerTerm*>(term.get());
    const bool zero = corner || term->traits().zero_tangent;
    FusedStepTerm* fused = zero ? nullptr : dynamic_cast<FusedStepTerm*>(term.get());
    PointStiffnessTerm* beside = zero || fused ? nullptr : dynamic_cast<PointStiffnessTerm*>(term.get());
    all_can_ = all_can_ && (fused || beside || zero);
    any_beside_ = any_beside_ || beside;
    parts_.push_back({term.get(), fused, beside, corner});
  }
  made_of_.clear();
  pattern_version_ = 0;
}

namespace {

/// Returns whether no pair of different nodes is in two of these lists, and none is in the pattern by a mass
/// alone. If the lists have more pairs in all than the pattern has off-diagonal blocks, some are shared; if
/// fewer, a mass adds some.
bool are_disjoint(const std::vector<const NodePairs*>& lists, const BlockSparse& pattern) {
  std::size_t pairs = 0;
  for (const NodePairs* own : lists)
    pairs += own->size() - static_cast<std::size_t>(std::count_if(
                               own->begin(), own->end(), [](const auto& p) { return p.first == p.second; }));
  return pairs == static_cast<std::size_t>(pattern.slot_count() - pattern.block_rows());
}

}  // namespace

/// Builds the pattern of the fused terms only.
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
  if (system_.any_master() || layout.nodal_size == 0 || system_.nodal_mass().size() != layout.nodal_size)
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

/// Reads the versions of the fused terms; returns false where one of them has no version.
bool StepAssembly::find_versions() {
  step_versions_.clear();
  for (const Part& part : parts_) {
    if (!part.fused) continue;
    step_versions_.push_back(part.fused->step_version());
    if (step_versions_.back() == 0) step_versions_.clear();
    if (step_versions_.empty()) return false;
  }
  return !step_versions_.empty();
}

namespace {

/// Relative difference of numbers that differ by the rounding of a time in a step.
constexpr double kSame = 1e-9;

bool equal(const VecX& kept, const double* now, Eigen::Index size) {
  return kept.size() == size && std::equal(now, now + size, kept.data());
}

bool alike(double kept, double now) { return std::abs(kept - now) <= kSame * std::abs(now); }

bool alike(const VecX& kept, const VecX& now, Eigen::Index size) {
  return kept.size() == size &&
         ((kept.array() - now.head(size).array()).abs() <= kSame * now.head(size).array().abs()).all();
}

}  // namespace

bool StepAssembly::is_kept(const StateView& state, const VecX& shift, double d_scale, double k_scale,
                           const ZeroRowSumMatrix& A) const {
  const CachedStep& kept = system_.kept_step();
  const Eigen::Index nodal = state.layout->nodal_size;
  return !kept.versions.empty() && kept.versions == step_versions_ && A.slot_map_key != 0 &&
         kept.slot_map_key == A.slot_map_key && kept.values.size() == A.values.size() &&
         kept.force.size() == state.layout->u_size && kept.scale == A.scale && alike(kept.d_scale, d_scale) &&
         alike(kept.k_scale, k_scale) && equal(kept.q, state.q.data(), nodal) &&
         equal(kept.u, state.u.data(), nodal) && alike(kept.shift, shift, nodal);
}

/// Adds the contribution of the fused terms.
/// @pre f is zero, and A holds m_scale M only
void StepAssembly::add_fused(const StateView& state, const VecX& shift, double d_scale, double k_scale,
                             VecX& f, ZeroRowSumMatrix& A, bool keep) {
  CachedStep& kept = system_.kept_step();
  const bool knows = (keep || !kept.versions.empty()) && find_versions();
  if (knows && is_kept(state, shift, d_scale, k_scale, A)) {
    counters::count("dynamics.kept_step_taken");
    f = kept.force;
    A.diagonal += kept.diagonal;
    std::copy(kept.values.begin(), kept.values.end(), A.values.begin());
    return;
  }
  const auto add = [&] {
    for (const Part& part : parts_)
      if (part.fused) part.fused->add_step(state, shift, k_scale, d_scale, f, A);
  };
  if (!knows || !keep) return add();
  kept.versions.clear();
  kept.diagonal = A.diagonal;
  A.diagonal.setZero();
  add();
  A.diagonal.swap(kept.diagonal);
  A.diagonal += kept.diagonal;
  const Eigen::Index nodal = state.layout->nodal_size;
  kept.slot_map_key = A.slot_map_key;
  kept.scale = A.scale;
  kept.d_scale = d_scale;
  kept.k_scale = k_scale;
  kept.q = state.q.head(nodal);
  kept.u = state.u.head(nodal);
  kept.shift = shift.head(nodal);
  kept.values = A.values;
  kept.force = f;
  kept.versions = step_versions_;
}

void StepAssembly::assemble(const StateView& state, const VecX& shift, double m_scale, double d_scale,
                            double k_scale, VecX& f, ZeroRowSumMatrix& A, bool keep) {
  assemble_bodies(state, shift, m_scale, d_scale, k_scale, f, A, keep);
  add_beside(state, shift, m_scale, d_scale, k_scale, f, A);
}

void StepAssembly::assemble_bodies(const StateView& state, const VecX& shift, double m_scale, double d_scale,
                                   double k_scale, VecX& f, ZeroRowSumMatrix& A, bool keep) {
  f.setZero(state.layout->u_size);
  A.scale = std::ldexp(1.0, -std::ilogb(system_.mean_nodal_mass()));
  A.diagonal = m_scale * system_.nodal_mass();
  A.positions = state.q.data();  // node blocks come first, with q' = u
  A.held = &system_.driven_nodes();
  add_fused(state, shift, d_scale, k_scale, f, A, keep);
  for (const Part& part : parts_)
    if (is_load(part)) part.term->add_force(state, f);
}

void StepAssembly::apply_body_damping(const StateView& state, const VecX& change, VecX& f) {
  for (const Part& part : parts_)
    if (part.fused) part.term->apply_tangent(state, 0.0, 1.0, change, f);
}

void StepAssembly::assemble_beside(const StateView& state, const VecX& shift, const VecX* change, double h,
                                   VecX& b, ZeroRowSumMatrix& A) {
  b.setZero(state.layout->u_size);
  add_beside(state, shift, 1.0, h, h * h, b, A);
  if (change && any_beside_) {
    product_.setZero(b.size());
    for (const Part& part : parts_)
      if (part.beside) part.term->apply_tangent(state, 0.0, 1.0, *change, product_);
    b -= product_;
  }
  b *= h;
  for (int dof : system_.driven_dofs()) b[dof] = 0.0;
}

/// Adds f += force - K shift and the matrix of the part beside, which is cleared before.
void StepAssembly::add_beside(const StateView& state, const VecX& shift, double m_scale, double d_scale,
                              double k_scale, VecX& f, ZeroRowSumMatrix& A) {
  const Layout& layout = *state.layout;
  A.points.clear();
  A.border.reset(layout.node_count(), layout.border_size());
  if (layout.border_size() > 0) add_corner(state, shift, m_scale, d_scale, k_scale, f, A.border.corner);
  for (const Part& part : parts_)
    if (part.beside) part.beside->add_step(state, shift, k_scale, d_scale, f, A.points, A.border);
}

/// Adds f += force - K shift of the terms on rigid blocks, and their matrix with the masses of these blocks.
/// @param corner  square, of the border's size
void StepAssembly::add_corner(const StateView& state, const VecX& shift, double m_scale, double d_scale,
                              double k_scale, VecX& f, MatX& corner) {
  corner_.corner.swap(corner);
  for (const auto& inertia : system_.inertias())
    if (state.layout->find(inertia->block_id())->kind != BlockKind::kNodes)
      inertia->add_mass(state, m_scale, corner_);
  for (const Part& part : parts_) {
    if (!part.corner) continue;
    part.term->add_force(state, f);
    if (!part.term->traits().has_tangent) continue;
    part.term->apply_tangent(state, -1.0, 0.0, shift, f);
    part.term->add_tangent(state, k_scale, d_scale, corner_);
  }
  corner_.corner.swap(corner);
}

void StepAssembly::residual(const StateView& state, const VecX& shift, const VecX& change, double h,
                            VecX& r) {
  PALPATE_CHECK(state.layout->border_size() == 0, "residual() of a step with rigid blocks");
  add_residual(state, shift, change, h, 0.0, true, r);
}

void StepAssembly::residual_of_bodies(const StateView& state, const VecX& shift, const VecX& change, double h,
                                      double rate, VecX& r) {
  add_residual(state, shift, change, h, rate, false, r);
}

void StepAssembly::add_residual(const StateView& state, const VecX& shift, const VecX& change, double h,
                                double rate, bool beside, VecX& r) {
  r.setZero(state.layout->u_size);
  for (const Part& part : parts_) {
    if (part.fused) part.fused->add_step_force_at_rate(state, shift, change, rate, r);
    if (part.beside && beside) part.beside->add_step_force(state, shift, change, r);
    if (is_load(part)) part.term->add_force(state, r);
  }
  const VecX& mass = system_.nodal_mass();
  r.head(mass.size()) = h * r.head(mass.size()) - mass.cwiseProduct(change.head(mass.size()));
  r.tail(r.size() - mass.size()) *= h;
  for (int dof : system_.driven_dofs()) r[dof] = 0.0;
}

}  // namespace palpate::dynamics
