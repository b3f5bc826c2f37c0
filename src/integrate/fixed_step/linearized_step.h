#pragma once
#include "integrate/step_solver.h"
#include "palpate/dynamics/mixed_precision_step.h"
#include "palpate/dynamics/repeated_step.h"
#include "palpate/dynamics/step_assembly.h"

namespace palpate::integrate {

/// The equations of a linearly implicit step of length h, everything evaluated at one state:
///     (M + h D + h^2 K) du = h (f - K s - D dv) - M dv       on free directions, du = 0 on driven ones.
struct LinearizedEquations {
  const dynamics::StateView& at;
  double h;
  const VecX& s;   ///< displacements, of free and driven directions
  const VecX& dv;  ///< velocity changes of driven directions; zero on free ones
  bool dv_is_zero;
};

/// Solves them, and again where terms take a part of their force from the step's end (RepeatedStepTerm),
/// until that is right.  What the soft bodies give is the same in all solves of a step, and is kept
/// (dynamics::KeptStep).  A solve, in order of cost:
///
///     lagged matrix      residuals of the true equations, without their matrix, refined by the
///                        mixed-precision matrix of an earlier step of this length
///     fused assembly     force, product and mixed-precision matrix in one pass, and a solve with it; with
///                        refinement where its rounding asks for it; again with projected tangents where it
///                        is indefinite
///     whole matrix       in double, by the policy of StepSolver
///
/// The first two want the capabilities MixedPrecisionSolver of the chosen solver and FusedStepTerm of the
/// system's terms; where these are lacking, or do not reach the tolerance, the next one is taken.
///
/// With a projected matrix, K_p, the right-hand side takes K_p as well, so that the step is
///     (M + h D + h^2 K_p) u1 = M u0 + h f + ...,
/// that of a force model without negative curvature: it may not gain energy.  With K itself there,
/// h^2 (K_p - K) u0 more, a moving body is pushed along that curvature, which has no bound where elements are
/// flat.  Where h is small enough for the order of the method to show, matrices are definite.
///
/// A matrix that is definite may still be so by the mass alone, and close to singular.  With R = h D + h^2 K
/// and the force g = f + D u0 that does not damp, the step is
///     (M + R) u1 = b,   b = M u0 + h g,   so that   u1.M u1 + u1.R u1 = u1.b
/// on free directions.  Where u1.R u1 >= -eta u1.M u1, by the inequality of Cauchy and Schwarz
///     (1 - eta) |u1| <= |u0 + h M^-1 g|   in the norm |u|^2 = u.M u:
/// the step moves no faster than a step without any stiffness would, up to 1 / (1 - eta), whatever else the
/// tangent has.  Where it is less, the step went along negative curvature and has no bound (with 1 + r, r the
/// part of R near -1, it is b / (1 + r)): it is solved once more, with projected tangents, whose R is
/// positive.  That takes b, which is one evaluation of the force, and is done only where |u1| is more than
/// |u0| / (1 - eta), for a step that is slower keeps the bound.  eta = tuning::kNegativeCurvature.
class LinearizedStep {
 public:
  LinearizedStep(dynamics::System& system, std::unique_ptr<dynamics::LinearSolver> solver,
                 const IntegratorSpec& spec);

  /// kNotFinite: the right-hand side is not finite; kSolverFailed: the matrix is singular or not finite.
  dynamics::StepStatus solve(const LinearizedEquations& equations, VecX& du,
                             dynamics::StepperCounters& counters);
  /// No later step is solved by a lagged matrix of now.
  void forget() { lagged_h_ = 0.0; }
  void report(dynamics::StepperCounters& counters) const { solver_.report(counters); }

 private:
  class Residual;
  class Repeats;
  using Equations = LinearizedEquations;

  bool solve_repeatedly(const Equations& e, VecX& du, Repeats& repeats);
  dynamics::StepStatus solve_once(const Equations& e, VecX& du);
  bool solve_by_lagged_matrix(const Equations& e, VecX& du);
  bool solve_fused(const Equations& e, VecX& du);
  bool solve_fused_projected(const Equations& e, VecX& du, dynamics::ZeroRowSumMatrix& A);
  dynamics::StepStatus solve_whole(const Equations& e, VecX& du);
  bool is_faster(const Equations& e, const VecX& du);
  bool goes_along_negative_curvature(const Equations& e, const VecX& du);
  bool goes_along_negative_curvature_of(const dynamics::BorderedMatrix& A, const Equations& e,
                                        const VecX& du);
  bool assemble_fused(const Equations& e, dynamics::ZeroRowSumMatrix& A, bool keep);
  void assemble_beside(const Equations& e, dynamics::PointStiffness& C, VecX& out);
  bool evaluate_right_hand_side(const Equations& e);
  bool complete_right_hand_side(const Equations& e);
  void evaluate_residual(const Equations& e, const VecX& du, VecX& r);

  dynamics::System& system_;
  StepSolver solver_;
  dynamics::MixedPrecisionSolver* mixed_;  ///< capability of the chosen solver; null: it lacks it
  dynamics::StepSolves* solves_;           ///< likewise
  dynamics::StepAssembly fused_;
  double roughly_;  ///< of a solve whose successor in the same step goes on from it: error over way
  dynamics::StepperCounters* counters_ = nullptr;  ///< of the solve under way
  dynamics::BorderedMatrix A_;
  VecX rhs_, product_, s_of_x_, dv_of_x_, u1_;
  VecX beside_, beside_before_;                              ///< of terms beside the pattern
  double speed_ = 0.0;                                       ///< u1.M u1 [J]
  bool known_indefinite_ = false;                            ///< the matrix of the solve under way is
  std::vector<dynamics::RepeatedStepTerm*> repeated_terms_;  ///< scratch
  bool repeats_ = false;   ///< the solve may be repeated from the same state
  double lagged_h_ = 0.0;  ///< step of the mixed-precision matrix that the solver keeps; 0: none
  std::uint64_t lagged_pattern_ = 0;
};

}  // namespace palpate::integrate
