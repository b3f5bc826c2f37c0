#pragma once

/// Tuned constants of the integrators, with the measurements behind them. All are dimensionless: shares of a
/// tolerance, ratios of steps, or counts.
namespace palpate::integrate::tuning {

// --- error tests

/// Tightest tolerance of an error test. The weights of q admit T atol_q q_scale: with the usual atol_q of
/// 0.01 and T = 1e-12, a hundred roundings (1e-16) of a coordinate of the body's size. A tighter test would
/// reject steps because of rounding.
inline constexpr double kTightestErrorTest = 1e-12;
/// Share of rtol, 1/kDefects, that the finite digits of a table, or the roundings of all steps, may add to
/// the error: a third.
inline constexpr double kDefects = 3.0;
/// Error test of cvode-adams, as a share of rtol. At its orders (6 to 12) it takes five to ten steps per
/// radian, whose errors add up. With 1 the error over a period of a spinning top is 5 to 40 times rtol.
inline constexpr double kAdamsShare = 0.1;
/// Number of error test failures allowed in one step. A discontinuous force (a damper at first contact) makes
/// the step shrink by a factor of ten per failure, until the jump is below the tolerance; SUNDIALS'
/// default of 7 fails at rtol 1e-8. The smallest step bounds the number in any case.
inline constexpr int kErrorTestFailures = 30;
/// Smallest step, as a share of the time to the next output: far below any physical time scale, above the
/// rounding of t.
inline constexpr double kSmallestStep = 1e-14;

// --- Newton's method of SUNDIALS, under error control

/// Runge-Kutta and multi-rate methods: tolerance of Newton's method, as a share of the tolerance of the step,
/// in place of ARKODE's tenth. The remaining error has the same sign from step to step while an old factor is
/// kept, and a method of order 2 takes thousands of steps.
inline constexpr double kNewtonShare = 0.01;
/// Largest number of iterations. CVODE's default of 3 is one less than the convergence test here needs, which
/// seldom accepts the first correction; ARKODE's default of 3 fails about once per step on soft bodies.
inline constexpr int kCvodeNewtonIterations = 4, kArkNewtonIterations = 8, kFixedPointIterations = 6;
/// Convergence test: smallest contraction rate assumed for an old tangent; decay of the observed rate
/// (SUNDIALS' default); growth of a correction that counts as divergence (SUNDIALS' default).
inline constexpr double kOldTangent = 0.05, kForgetContraction = 0.3, kDivergingCorrection = 2.0;
/// Error that an iterative linear solver may leave in a correction, as a share of Newton's tolerance.
inline constexpr double kLinearShare = 0.05;

// --- multi-rate methods

/// Tolerance of the fast side, as a share of rtol, so that the slow step determines the order.
inline constexpr double kFastShare = 1e-3;
/// Smallest limit of the number of fast steps; a lower max_steps applies to the slow steps only.
inline constexpr int kLeastFastSteps = 1000;

// --- Newton's method of fixed steps (newton.h, Deuflhard 2004)

/// Largest number of iterations with the true tangent, and with a definite one, renewed at each iterate.
inline constexpr int kNewtonIterations = 20, kDefiniteIterations = 60;
/// Contraction above which a kept factor is renewed; smallest damping of a correction.
inline constexpr double kSlowContraction = 0.5, kSmallestDamping = 1.0 / 64.0;
/// Relative change of a step matrix's coefficients up to which a kept factor is still used.
inline constexpr double kOtherCoefficients = 0.1;
/// A step that fails is divided into parts, down to 1/2^kHalvings.
inline constexpr int kHalvings = 6;
/// Relative tolerance for comparing steps: lengths that differ by less are equal.
inline constexpr double kRoundingOfStep = 1e-9;
/// Relative rounding of a state, or of forces that cancel in an equilibrium: a correction below it is
/// rounding.
inline constexpr double kRounding = 1e-14;

// --- linearly implicit steps (linearized_step.h)

/// Negative curvature that a step may follow, relative to its mass; 1 is a singular matrix. A body that
/// buckles at the rate sigma has (sigma h)^2, so that rates up to 1/(3 h) keep their true tangent. The
/// speed of a step is bounded by 1.11 times the speed of a body without stiffness.
inline constexpr double kNegativeCurvature = 0.1;

// --- statics (kinsol_static.cpp)

/// Largest number of Newton iterations per load step.
inline constexpr long kStaticIterations = 25;
/// Smallest load step, as a share of the load; largest number of proximal steps per load step.
inline constexpr double kShortestLoadStep = 1.0 / 64.0;
inline constexpr int kProximalSteps = 200;
/// Iterative refinement at the rounding limit: largest number of corrections, each of which must lower the
/// residual at least to this share.
inline constexpr int kRefinements = 3;
inline constexpr double kRefinementHelps = 0.5;

}  // namespace palpate::integrate::tuning
