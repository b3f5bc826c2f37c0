#pragma once
#include <Eigen/LU>

#include "palpate/dynamics/step_assembly.h"

namespace palpate::integrate {

/// Equations of a linearly implicit step of length h, with all quantities evaluated at one state:
///     (M + h D + h^2 K) du = h (f - K s - D dv) - M dv       on free directions, du = 0 on driven ones.
struct LinearizedEquations {
  const dynamics::StateView& at;
  double h;
  const VecX& s;   ///< Displacements of free and driven directions.
  const VecX& dv;  ///< Velocity changes of driven directions; zero on free ones.
  bool dv_is_zero;
  /// s = h (u + dv) up to rounding, so that the displacements s + h du are proportional to the velocities.
  bool is_proportional = false;
};

/// These equations by the fused assembly (dynamics::StepAssembly): right-hand side, matrix in mixed
/// precision, and residuals of the true equations without their matrix.
///
/// Rigid blocks (a tool) are eliminated. With the nodes n and the velocities b of rigid blocks the equations
/// are
///     [A R] [x_n]   [b_n]
///     [L C] [x_b] = [b_b],      so that   x_b = C^-1 (b_b - L x_n),
///     (A - R C^-1 L) x_n = b_n - R C^-1 b_b.
/// R and L have entries at nodes in contact, C is small and dense (dynamics::SparseBorder). The solver is
/// given the nodes' equations with a symmetric matrix, A - B S^-1 B^T, B = (R + L^T)/2, S = (C + C^T)/2. What
/// that leaves out is unsymmetric: rotations do not commute, and dampers turn with the tool
/// (contact/tangent.cpp). It is small, of the order of the rotation per step, and contained in the residual,
/// which iterative refinement reduces to the tolerance:
///     r_n = b_n - A x_n - R x_b       for x_b of x_n as above;  r_b = 0.
/// The energy norm of an error in x_n is in the matrix A - B S^-1 B^T the norm of both errors in that of the
/// whole matrix, as x_b minimises it.
class FusedEquations {
 public:
  using Equations = LinearizedEquations;
  explicit FusedEquations(dynamics::System& system) : system_(system), assembly_(system) {}

  /// Returns whether the step at this state can be assembled in this way. Updates the pattern.
  bool applies(const dynamics::StateView& at) { return assembly_.applies(at); }
  const dynamics::BlockSparse& pattern() const { return assembly_.pattern(); }

  /// Assembles matrix and right-hand side. Returns false where the right-hand side is not finite.
  /// @param keep  as for StepAssembly::assemble()
  bool assemble(const Equations& e, dynamics::ZeroRowSumMatrix& A, bool keep);
  /// Assembles the part of contact and of rigid blocks, as part of assemble() or again at the same or another
  /// state: A.points, A.border and their share of the right-hand side. Later residuals read these. Returns
  /// false where that share is not finite.
  /// @param A  must stay at its address until the last residual
  bool assemble_beside(const Equations& e, dynamics::ZeroRowSumMatrix& A);
  /// Writes the right-hand side, all rows.
  void right_hand_side(VecX& b) const { b = of_bodies_ + beside_; }

  /// Computes the residual of all rows. @pre assemble_beside() was called for these equations
  void residual(const Equations& e, const VecX& du, VecX& r);
  /// Computes the rows of rigid blocks of a solution from its nodal rows.
  void complete(VecX& du);

 private:
  dynamics::System& system_;
  dynamics::StepAssembly assembly_;
  const dynamics::ZeroRowSumMatrix* A_ = nullptr;  ///< Matrix with the current points and border.
  VecX of_bodies_, beside_;                        ///< Shares of the right-hand side.
  VecX s_of_x_, dv_of_x_, product_;
  Eigen::PartialPivLU<MatX> corner_;  ///< Factors of C.
  VecX border_rows_;
};

}  // namespace palpate::integrate
