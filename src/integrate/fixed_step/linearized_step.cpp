#include "integrate/fixed_step/linearized_step.h"

#include <cmath>
#include <utility>

#include "core/clock.h"
#include "core/finite.h"
#include "integrate/tuning.h"

namespace palpate::integrate {

using dynamics::SolveStatus;
using dynamics::StepMatrixUse;
using dynamics::StepStatus;

namespace {

constexpr double kSameStep = 1e-6;  // Relative difference of steps that differ by rounding.
/// Relative improvement of the guess by the last but one solve of a step. Each solve squares the error of the
/// guess, and the last one leaves less than a thousandth.
constexpr double kLastImprovement = 0.02;
/// Upper limit of the error of a solve that another one continues, relative to the change of the solution.
constexpr double kRoughly = 0.1;

/// Returns whether there are rigid blocks, which the nodes' equations contain in residuals only.
bool is_bordered(const LinearizedEquations& e) { return e.at.layout->border_size() > 0; }

}  // namespace

LinearizedStep::LinearizedStep(dynamics::System& system, std::unique_ptr<dynamics::LinearSolver> solver,
                               const IntegratorSpec& spec)
    : system_(system),
      solver_(std::move(solver), spec),
      mixed_(dynamic_cast<dynamics::MixedPrecisionSolver*>(&solver_.chosen())),
      solves_(dynamic_cast<dynamics::StepSolves*>(&solver_.chosen())),
      tolerance_(dynamic_cast<dynamics::EnergyTolerance*>(&solver_.chosen())),
      fused_(system),
      roughly_(std::min(kRoughly, spec.linear_rtol / kLastImprovement)) {}

LinearizedStep::Repeats::Repeats(LinearizedStep& step, const dynamics::StateView& at)
    : at_(at), terms_(step.repeated_terms_) {
  terms_.clear();
  for (const auto& term : step.system_.terms())
    if (auto* const repeated = dynamic_cast<dynamics::RepeatedStepTerm*>(term.get());
        repeated && repeated->begin_step(at))
      terms_.push_back(repeated);
}

LinearizedStep::Repeats::~Repeats() {
  for (dynamics::RepeatedStepTerm* term : terms_) term->end_step();
}

bool LinearizedStep::Repeats::improve(const VecX& moved, const VecX& change) {
  bool done = true;
  for (dynamics::RepeatedStepTerm* term : terms_) done = term->improve_step(at_, moved, change) && done;
  return done;
}

StepStatus LinearizedStep::solve(const Equations& e, VecX& du, dynamics::StepperCounters& counters) {
  Repeats repeats(*this, e.at);
  return solve(e, repeats, du, counters);
}

StepStatus LinearizedStep::solve(const Equations& e, Repeats& repeats, VecX& du,
                                 dynamics::StepperCounters& counters) {
  counters_ = &counters;
  known_indefinite_ = false;
  allow_rounding(e);
  repeats_ = repeats.any();
  if (repeats_ && solve_repeatedly(e, du, repeats)) return StepStatus::kOk;
  for (;;) {
    const StepStatus status = solve_once(e, du);
    if (status != StepStatus::kOk || !repeats_ || !all_finite(du)) return status;
    s_of_x_ = e.s + e.h * du;
    dv_of_x_ = e.dv + du;
    if (repeats.improve(s_of_x_, dv_of_x_)) return status;
  }
}

/// Solves with one assembly of the bodies' contribution and one packing of the matrix: from solve to solve
/// only the part outside the sparsity pattern changes, with its share of the right-hand side. A solve that is
/// followed by another one need not be more accurate than the guess that it improves. Once the guess has
/// converged, the last solve continues to the tolerance. All solves together cost little more than one.
/// Returns false where no solution was found and the step has to be solved otherwise.
bool LinearizedStep::solve_repeatedly(const Equations& e, VecX& du, Repeats& repeats) {
  if (!mixed_ || !solves_ || is_bordered(e) || !fused_.applies(e.at)) return false;
  dynamics::ZeroRowSumMatrix* A = mixed_->step_matrix(fused_.pattern());
  if (!A) return false;
  forget();
  ++counters_->force_evaluations;
  if (!assemble_fused(e, *A, false) || mixed_->factor_step_matrix() != StepMatrixUse::kSolve) return false;
  dynamics::StepSolves::Solved solved = solves_->solve_first(rhs_, du, roughly_);
  for (double share = roughly_;;) {
    if (solved.status != SolveStatus::kOk || !all_finite(du)) return false;
    s_of_x_ = e.s + e.h * du;
    dv_of_x_ = e.dv + du;
    const bool done = repeats.improve(s_of_x_, dv_of_x_);
    if (done && (solved.accurate || share == 0.0)) break;
    share = done ? 0.0 : roughly_;
    if (!assemble_beside(e, *A)) return false;
    fused_.right_hand_side(rhs_);
    solved = solves_->solve_next(rhs_, du, share);
  }
  if (goes_along_negative_curvature(e, du)) return false;
  solves_->end_solves(du);
  return true;
}

/// Assembles the contribution of contact and rigid blocks to matrix and right-hand side; returns false where
/// the latter is not finite.
bool LinearizedStep::assemble_beside(const Equations& e, dynamics::ZeroRowSumMatrix& A) {
  const ScopedTimer timer(counters_->tangent_s);
  return fused_.assemble_beside(e, A);
}

void LinearizedStep::allow_rounding(const Equations& e) {
  if (!tolerance_ || e.h == rounding_h_) return;
  rounding_h_ = e.h;
  double size = 0.0;
  for (const dynamics::Block& block : e.at.layout->blocks)
    if (block.kind == dynamics::BlockKind::kNodes) size = std::max(size, block.q_scale);
  // nodal_mass() has three equal entries per node
  tolerance_->allow_error(0x1p-52 * size * std::sqrt(system_.nodal_mass().sum() / 3.0) / e.h);
}

StepStatus LinearizedStep::solve_once(const Equations& e, VecX& du) {
  if (mixed_ && fused_.applies(e.at)) {
    if (solve_by_lagged_matrix(e, du)) {
      if (!goes_along_negative_curvature(e, du)) return StepStatus::kOk;
      known_indefinite_ = true;
    }
    if (solve_fused(e, du)) return StepStatus::kOk;
  }
  return solve_whole(e, du);
}

/// Residual of the nodes' equations as a function of the nodal rows of du.
class LinearizedStep::NodalResidual final : public dynamics::ResidualFunction {
 public:
  NodalResidual(LinearizedStep& of, const Equations& e) : of_(of), e_(e) {}
  void at(const VecX& x, VecX& r) override {
    if (!is_bordered(e_)) return of_.evaluate_residual(e_, x, r);
    VecX& du = of_.du_;
    du.resize(e_.at.layout->u_size);
    du.head(x.size()) = x;
    of_.fused_.complete(du);
    of_.evaluate_residual(e_, du, r);
  }

 private:
  LinearizedStep& of_;
  const Equations& e_;
};

/// Solves by refinement with the mixed-precision matrix that the solver has.
std::optional<SolveStatus> LinearizedStep::refine(const Equations& e, VecX& du) {
  NodalResidual residual(*this, e);
  if (!is_bordered(e)) return mixed_->solve_by_refinement(residual, du);
  const std::optional<SolveStatus> status = mixed_->solve_by_refinement(residual, nodal_du_);
  if (status != SolveStatus::kOk) return status;
  du.resize(e.at.layout->u_size);
  du.head(nodal_du_.size()) = nodal_du_;
  fused_.complete(du);
  return status;
}

void LinearizedStep::evaluate_residual(const Equations& e, const VecX& du, VecX& r) {
  const ScopedTimer timer(counters_->force_s);
  ++counters_->force_evaluations;
  fused_.residual(e, du, r);
}

/// Returns u.M u.
double LinearizedStep::square_norm(const Equations& e, const VecX& u) {
  const VecX& mass = system_.nodal_mass();
  const Eigen::Index nodal = mass.size(), border = u.size() - nodal;
  if (nodal != e.at.layout->nodal_size) {
    system_.apply_mass(e.at, u, product_);
    return u.dot(product_);
  }
  const double sum = u.head(nodal).dot(mass.cwiseProduct(u.head(nodal)));
  if (border == 0) return sum;
  product_.resize(u.size());
  product_.tail(border).setZero();
  for (const auto& inertia : system_.inertias())
    if (e.at.layout->find(inertia->block_id())->kind != dynamics::BlockKind::kNodes)
      inertia->apply(e.at, u, product_);
  return sum + u.tail(border).dot(product_.tail(border));
}

/// Returns whether |u1| > |u0| / (1 - eta) on free directions. Sets u1_ to u1 there, and to zero on driven
/// ones.
bool LinearizedStep::is_faster(const Equations& e, const VecX& du) {
  if (!solver_.projects()) return false;
  constexpr double kMost = 1.0 / (1.0 - tuning::kNegativeCurvature);
  u1_ = e.at.u;
  for (const int dof : system_.driven_dofs()) u1_[dof] = 0.0;
  const double before = square_norm(e, u1_);
  u1_ += du;  // Zero along driven directions.
  speed_ = square_norm(e, u1_);
  return speed_ > kMost * kMost * before;
}

/// Checks the fused equations. Their residual at du = -u0 is b (less the effect of driven directions on free
/// ones, which belongs to it).
bool LinearizedStep::goes_along_negative_curvature(const Equations& e, const VecX& du) {
  if (!is_faster(e, du)) return false;
  dv_of_x_ = -e.at.u;
  for (const int dof : system_.driven_dofs()) dv_of_x_[dof] = 0.0;
  evaluate_residual(e, dv_of_x_, product_);
  return u1_.dot(product_) < (1.0 - tuning::kNegativeCurvature) * speed_;
}

/// Checks the assembled matrix: u1.A u1 = u1.M u1 + u1.R u1.
bool LinearizedStep::goes_along_negative_curvature_of(const dynamics::BorderedMatrix& A, const Equations& e,
                                                      const VecX& du) {
  if (!A.symmetric || !is_faster(e, du)) return false;
  A.multiply(u1_, product_);
  return u1_.dot(product_) < (1.0 - tuning::kNegativeCurvature) * speed_;
}

bool LinearizedStep::solve_by_lagged_matrix(const Equations& e, VecX& du) {
  if (!(std::abs(e.h - lagged_h_) <= kSameStep * e.h) ||
      fused_.pattern().pattern_version() != lagged_pattern_)
    return false;
  dynamics::ZeroRowSumMatrix* A = mixed_->lagged_matrix();
  if (!A || !assemble_beside(e, *A)) return false;
  mixed_->renew_points();
  return refine(e, du) == SolveStatus::kOk;
}

/// Assembles force, product and matrix; returns false where the right-hand side is not finite.
bool LinearizedStep::assemble_fused(const Equations& e, dynamics::ZeroRowSumMatrix& A, bool keep) {
  const ScopedTimer timer(counters_->tangent_s);
  ++counters_->tangent_evaluations;
  if (!fused_.assemble(e, A, keep)) return false;
  fused_.right_hand_side(rhs_);
  return true;
}

bool LinearizedStep::solve_fused(const Equations& e, VecX& du) {
  dynamics::ZeroRowSumMatrix* A = mixed_->step_matrix(fused_.pattern());
  if (!A) return false;
  forget();
  ++counters_->force_evaluations;
  if (known_indefinite_) {
    solver_.count_indefinite();
    return solve_fused_projected(e, du, *A);
  }
  if (!assemble_fused(e, *A, repeats_)) return false;
  SolveStatus status = SolveStatus::kSingular;
  const StepMatrixUse use = mixed_->factor_step_matrix();
  switch (use) {
    case StepMatrixUse::kSolve: status = solver_.chosen().solve(rhs_, du); break;
    case StepMatrixUse::kRefine: status = refine(e, du).value_or(SolveStatus::kNotConverged); break;
    case StepMatrixUse::kIndefinite: status = SolveStatus::kIndefinite; break;
    case StepMatrixUse::kNone: break;
  }
  if (status == SolveStatus::kOk && goes_along_negative_curvature(e, du)) status = SolveStatus::kIndefinite;
  if (status == SolveStatus::kIndefinite) {
    known_indefinite_ = true;
    solver_.count_indefinite();
    return (use != StepMatrixUse::kRefine || is_bordered(e)) && solver_.projects() &&
           solve_fused_projected(e, du, *A);
  }
  if (status != SolveStatus::kOk) return false;
  lagged_h_ = e.h;
  lagged_pattern_ = fused_.pattern().pattern_version();
  return true;
}

/// Solves with projected tangents. This matrix is not kept as a lagged matrix.
bool LinearizedStep::solve_fused_projected(const Equations& e, VecX& du, dynamics::ZeroRowSumMatrix& A) {
  const ProjectedTangents projected(system_);
  if (!assemble_fused(e, A, repeats_)) return false;
  const StepMatrixUse use = mixed_->factor_step_matrix();
  if (use != StepMatrixUse::kSolve && !(use == StepMatrixUse::kRefine && is_bordered(e))) return false;
  solver_.count_projected();
  return (is_bordered(e) ? refine(e, du) : solver_.chosen().solve(rhs_, du)) == SolveStatus::kOk;
}

StepStatus LinearizedStep::solve_whole(const Equations& e, VecX& du) {
  forget();
  if (!evaluate_right_hand_side(e)) return StepStatus::kNotFinite;
  const auto assemble = [&] {
    const ScopedTimer timer(counters_->tangent_s);
    ++counters_->tangent_evaluations;
    system_.step_matrix(e.at, 1.0, e.h, e.h * e.h, A_);
  };
  SolveStatus status;
  if (known_indefinite_) {
    status = solver_.factor_indefinite(A_, system_, assemble);
  } else {
    assemble();
    status = solver_.factor(A_, system_, assemble);
  }
  bool rhs_projected = false;
  const auto right_hand_side = [&]() -> const VecX& {
    if (rhs_projected == solver_.projected()) return rhs_;
    rhs_projected = solver_.projected();
    if (rhs_projected) {
      const ProjectedTangents projected(system_);
      evaluate_right_hand_side(e);
    } else {
      evaluate_right_hand_side(e);
    }
    return rhs_;
  };
  if (status == SolveStatus::kOk) status = solver_.solve(system_, assemble, right_hand_side, du);
  if (status == SolveStatus::kOk && !solver_.projected() && goes_along_negative_curvature_of(A_, e, du)) {
    solver_.count_indefinite();
    status = solver_.factor_indefinite(A_, system_, assemble);
    if (status == SolveStatus::kOk) status = solver_.solve(system_, assemble, right_hand_side, du);
  }
  return status == SolveStatus::kOk ? StepStatus::kOk : StepStatus::kSolverFailed;
}

/// Evaluates the whole right-hand side; returns false where it is not finite.
bool LinearizedStep::evaluate_right_hand_side(const Equations& e) {
  const ScopedTimer timer(counters_->force_s);
  ++counters_->force_evaluations;
  system_.force(e.at, rhs_);
  product_.setZero(rhs_.size());
  for (const auto& term : system_.terms())
    if (term->traits().has_tangent) term->apply_tangent(e.at, 1.0, 0.0, e.s, product_);
  rhs_ -= product_;
  if (!e.dv_is_zero) {
    product_.setZero(rhs_.size());
    for (const auto& term : system_.terms())
      if (term->traits().has_tangent) term->apply_tangent(e.at, 0.0, 1.0, e.dv, product_);
    rhs_ -= product_;
  }
  rhs_ *= e.h;
  if (!e.dv_is_zero) {
    system_.apply_mass(e.at, e.dv, product_);
    rhs_ -= product_;
  }
  system_.reduce(e.at, rhs_);
  if (system_.any_driven()) {  // Geometric stiffness of the nodes that rigid blocks carry.
    product_.setZero(rhs_.size());
    system_.apply_carried_stiffness(e.at, e.s, product_);
    rhs_ -= e.h * product_;
  }
  return all_finite(rhs_);
}

}  // namespace palpate::integrate
