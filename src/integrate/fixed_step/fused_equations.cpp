#include "integrate/fixed_step/fused_equations.h"

#include "core/finite.h"

namespace palpate::integrate {

bool FusedEquations::assemble(const Equations& e, dynamics::ZeroRowSumMatrix& A, bool keep) {
  assembly_.assemble_bodies(e.at, e.s, 1.0, e.h, e.h * e.h, of_bodies_, A, keep);
  if (!e.dv_is_zero) {
    product_.setZero(of_bodies_.size());
    assembly_.apply_body_damping(e.at, e.dv, product_);
    of_bodies_ -= product_;
  }
  of_bodies_ *= e.h;
  if (!e.dv_is_zero) {
    const VecX& mass = system_.nodal_mass();
    of_bodies_.head(mass.size()) -= mass.cwiseProduct(e.dv.head(mass.size()));
  }
  for (const int dof : system_.driven_dofs()) of_bodies_[dof] = 0.0;
  return assemble_beside(e, A) && all_finite(of_bodies_);
}

bool FusedEquations::assemble_beside(const Equations& e, dynamics::ZeroRowSumMatrix& A) {
  A_ = &A;
  assembly_.assemble_beside(e.at, e.s, e.dv_is_zero ? nullptr : &e.dv, e.h, beside_, A);
  if (!all_finite(beside_)) return false;
  if (!A.border.empty()) corner_.compute(A.border.corner);
  return true;
}

/// Computes r = h (f - K (s + h du) - D (dv + du)) - M (dv + du) on free directions. The part of contact
/// and rigid blocks is linear in du with a matrix that is known.
void FusedEquations::residual(const Equations& e, const VecX& du, VecX& r) {
  s_of_x_ = e.s + e.h * du;
  if (!e.dv_is_zero) dv_of_x_ = e.dv + du;
  assembly_.residual_of_bodies(e.at, s_of_x_, e.dv_is_zero ? du : dv_of_x_, e.h,
                               e.is_proportional ? 1.0 / e.h : 0.0, r);
  r += beside_;
  A_->points.add_product(du, -1.0, r);
  if (const dynamics::SparseBorder& border = A_->border; !border.empty()) {
    border.add_right_product(du, -1.0, r);
    border_rows_.noalias() = border.corner * du.tail(border.size());
    border.add_bottom_product(du, 1.0, border_rows_);
    r.tail(border.size()) -= border_rows_;
  }
  for (const int dof : system_.driven_dofs()) r[dof] = 0.0;
}

void FusedEquations::complete(VecX& du) {
  const dynamics::SparseBorder& border = A_->border;
  if (border.empty()) return;
  border_rows_ = beside_.tail(border.size());
  border.add_bottom_product(du, -1.0, border_rows_);
  du.tail(border.size()) = corner_.solve(border_rows_);
}

}  // namespace palpate::integrate
