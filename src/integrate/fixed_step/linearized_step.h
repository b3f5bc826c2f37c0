#pragma once
#include "dynamics/energy_tolerance.h"
#include "dynamics/mixed_precision_step.h"
#include "integrate/fixed_step/fused_equations.h"
#include "integrate/step_solver.h"
#include "palpate/dynamics/repeated_step.h"

namespace palpate::integrate {

/// Solves the equations of linearly implicit steps (LinearizedEquations). Where terms evaluate a part of
/// their force at the end of the step (RepeatedStepTerm) the solve is repeated until that part has converged.
/// The contribution of the soft bodies is the same in all solves of a step, and is kept
/// (dynamics::CachedStep). Methods of one solve, in order of cost:
///
///     lagged matrix      residuals of the true equations, without their matrix, refined by the
///                        mixed-precision matrix of an earlier step of this length, with the contact and the
///                        rigid blocks of this one
///     fused assembly     force, product and mixed-precision matrix in one pass, and a solve with it; with
///                        refinement where its rounding or rigid blocks require it (FusedEquations); again
///                        with projected tangents where it is indefinite
///     whole matrix       in double, by the policy of StepSolver
///
/// The first two require the capabilities MixedPrecisionSolver of the chosen solver and FusedStepTerm of the
/// system's terms; where these are missing, or do not reach the tolerance, the next method is used.
///
/// Tolerance: relative to the change du, not to the velocity u1, as errors of all steps add up: an error of
/// rtol |du| per step is one of rtol in the force. At rest du is rounding, and so is the residual, so that no
/// relative tolerance can be met there. Errors below the rounding of the positions are therefore accepted,
///     |e|_A <= eps |q| sqrt(m) / h,   which contains h sqrt(mean of |e|^2) <= eps |q|,
/// eps = 2^-52, m the mass of the nodes, |q| the size of the bodies.
///
/// With a projected matrix, K_p, the right-hand side uses K_p as well, so that the step is
///     (M + h D + h^2 K_p) u1 = M u0 + h f + ...,
/// the step of a force model without negative curvature, which cannot gain energy. With K in the right-hand
/// side, which adds h^2 (K_p - K) u0, a moving body is accelerated along the negative curvature, without
/// bound where elements are flat. Where h is small enough for the order of the method to be observed,
/// matrices are definite.
///
/// A definite matrix may be so only because of the mass, and be close to singular. With R = h D + h^2 K and
/// the undamped force g = f + D u0, the step is
///     (M + R) u1 = b,   b = M u0 + h g,   so that   u1.M u1 + u1.R u1 = u1.b
/// on free directions. Where u1.R u1 >= -eta u1.M u1, the Cauchy-Schwarz inequality yields
///     (1 - eta) |u1| <= |u0 + h M^-1 g|   in the norm |u|^2 = u.M u:
/// the step is no faster than a step without any stiffness, up to 1 / (1 - eta), whatever else the tangent
/// contains. Otherwise the step followed a direction of negative curvature and has no bound (with 1 + r, r
/// the part of R near -1, it is b / (1 + r)): it is repeated with projected tangents, for which R is
/// positive. The check needs b, which is one evaluation of the force, and is done only where |u1| is more
/// than |u0| / (1 - eta), as a slower step satisfies the bound. eta = tuning::kNegativeCurvature.
class LinearizedStep {
 public:
  LinearizedStep(dynamics::System& system, std::unique_ptr<dynamics::LinearSolver> solver,
                 const IntegratorSpec& spec);

  /// Terms whose force depends on the end of the step that begins at a state (RepeatedStepTerm). begin_step()
  /// and end_step() are called by constructor and destructor. One at a time.
  class Repeats {
   public:
    /// @param at  must outlive this object
    Repeats(LinearizedStep& step, const dynamics::StateView& at);
    ~Repeats();
    Repeats(const Repeats&) = delete;
    Repeats& operator=(const Repeats&) = delete;
    bool any() const { return !terms_.empty(); }
    /// Takes the end of the step that a solve found, as RepeatedStepTerm::improve_step(); returns whether the
    /// guesses of all terms have converged.
    bool improve(const VecX& moved, const VecX& change);

   private:
    const dynamics::StateView& at_;
    std::vector<dynamics::RepeatedStepTerm*>& terms_;  ///< Scratch, so that a step allocates no memory.
  };

  /// Solves for du. Returns kNotFinite where the right-hand side is not finite, kSolverFailed where the
  /// matrix is singular or not finite.
  dynamics::StepStatus solve(const LinearizedEquations& equations, VecX& du,
                             dynamics::StepperCounters& counters);
  /// Does the same where the caller has begun the step, at the state of the equations.
  dynamics::StepStatus solve(const LinearizedEquations& equations, Repeats& repeats, VecX& du,
                             dynamics::StepperCounters& counters);
  /// Discards the lagged matrix: no later step is solved by a matrix made before this call.
  void forget() { lagged_h_ = 0.0; }
  void report(dynamics::StepperCounters& counters) const { solver_.report(counters); }

 private:
  class NodalResidual;
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
  bool assemble_beside(const Equations& e, dynamics::ZeroRowSumMatrix& A);
  std::optional<dynamics::SolveStatus> refine(const Equations& e, VecX& du);
  void allow_rounding(const Equations& e);
  bool evaluate_right_hand_side(const Equations& e);
  void evaluate_residual(const Equations& e, const VecX& du, VecX& r);
  double square_norm(const Equations& e, const VecX& u);

  dynamics::System& system_;
  StepSolver solver_;
  dynamics::MixedPrecisionSolver* mixed_;  ///< Capability of the chosen solver; null: it lacks it.
  dynamics::StepSolves* solves_;           ///< As above.
  dynamics::EnergyTolerance* tolerance_;   ///< As above.
  FusedEquations fused_;
  /// Tolerance of solves that another solve of the same step continues: error relative to the change of the
  /// solution.
  double roughly_;
  dynamics::StepperCounters* counters_ = nullptr;  ///< Counters of the current solve.
  dynamics::BorderedMatrix A_;
  VecX rhs_, product_, s_of_x_, dv_of_x_, u1_;
  VecX du_, nodal_du_;             ///< Solutions on their way: all rows, and those of the nodes.
  double speed_ = 0.0;             ///< u1.M u1 [J].
  bool known_indefinite_ = false;  ///< The matrix of the current solve is known to be indefinite.
  std::vector<dynamics::RepeatedStepTerm*> repeated_terms_;  ///< Scratch.
  bool repeats_ = false;     ///< The solve may be repeated from the same state.
  double rounding_h_ = 0.0;  ///< Step for which the solver has an absolute tolerance.
  double lagged_h_ = 0.0;    ///< Step of the mixed-precision matrix that the solver keeps; 0: none.
  std::uint64_t lagged_pattern_ = 0;
};

}  // namespace palpate::integrate
