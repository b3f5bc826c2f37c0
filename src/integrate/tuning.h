#pragma once

/// What is tuned in the integrators, and what it was measured against.  Nothing here has a unit: each is a
/// share of a tolerance, a ratio of steps, or a count.
namespace palpate::integrate::tuning {

// --- error tests

/// The tightest tolerance of an error test.  The weights of q admit T atol_q q_scale, with the usual atol_q
/// of 0.01 and T = 1e-12 a hundred roundings (1e-16) of a coordinate of the body's size: a test that is held
/// to less rejects roundings.
inline constexpr double kTightestErrorTest = 1e-12;
/// What a table's own digits, or the roundings of all steps, may add to an error: a third of rtol.
inline constexpr double kDefects = 3.0;
/// The error test of cvode-adams, of rtol: at the orders that it takes (6 to 12) it makes five to ten steps a
/// radian, and their errors add up.  With 1 it errs by 5 to 40 times rtol over a period of a spinning top.
inline constexpr double kAdamsShare = 0.1;
/// Error tests that may fail in one step.  A force that jumps (a damper at first touch) makes the step shrink
/// by ten a failure, down to where the jump is below the tolerance; SUNDIALS' own limit of 7 gives up at rtol
/// 1e-8.  A smallest step bounds it in any case.
inline constexpr int kErrorTestFailures = 30;
/// The smallest step, of the time to the next output: far below any physical time scale, above the rounding
/// of t.
inline constexpr double kSmallestStep = 1e-14;

// --- Newton's method of SUNDIALS, under error control

/// Runge-Kutta and multi-rate methods: Newton ends at this share of the tolerance, not at ARKODE's tenth.
/// What it leaves has one sign from step to step while an old factor is kept, and a method of order 2 takes
/// thousands of steps.
inline constexpr double kNewtonShare = 0.01;
/// Iterations.  CVODE's own 3 are one less than our test of convergence needs, which seldom takes the first
/// correction; ARKODE's own 3 fail about once a step on soft bodies.
inline constexpr int kCvodeNewtonIterations = 4, kArkNewtonIterations = 8, kFixedPointIterations = 6;
/// Least contraction that the test of convergence believes in, for a tangent that has aged; how slowly it
/// forgets the contractions seen (SUNDIALS' own); growth of a correction that is divergence (SUNDIALS' own).
inline constexpr double kOldTangent = 0.05, kForgetContraction = 0.3, kDivergingCorrection = 2.0;
/// Error that an iterative linear solver may leave in a correction, as a share of Newton's tolerance.
inline constexpr double kLinearShare = 0.05;

// --- multi-rate methods

/// The fast side is integrated to this share of rtol, so that the slow step decides the order.
inline constexpr double kFastShare = 1e-3;
/// A small max_steps is meant for the slow steps.
inline constexpr int kLeastFastSteps = 1000;

// --- Newton's method of fixed steps (newton.h, Deuflhard 2004)

/// Iterations with the true tangent, and with a definite one, fresh each time.
inline constexpr int kNewtonIterations = 20, kDefiniteIterations = 60;
/// Contraction above which a kept factor is renewed; the least damping of a correction.
inline constexpr double kSlowContraction = 0.5, kSmallestDamping = 1.0 / 64.0;
/// Change of a step matrix's coefficients, relative, up to which a kept factor is used on.
inline constexpr double kOtherCoefficients = 0.1;
/// A step that fails is taken in parts, down to 1/2^kHalvings of it.
inline constexpr int kHalvings = 6;
/// Of a step: what is longer than another by less is as long.
inline constexpr double kRoundingOfStep = 1e-9;
/// Of a state, or of the forces that cancel in a balance: a correction below it is rounding.
inline constexpr double kRounding = 1e-14;

// --- linearly implicit steps (linearized_step.h)

/// Negative curvature that a step may go along, of its mass: 1 is a singular matrix.  A body that buckles at
/// the rate sigma has (sigma h)^2, so that rates up to 1/(3 h) keep their true tangent; a step's speed is
/// bounded by 1.11 times that of a body without stiffness.
inline constexpr double kNegativeCurvature = 0.1;

// --- statics (kinsol_static.cpp)

inline constexpr long kStaticIterations = 25;
/// The load ladder's shortest rung, of the load; proximal steps up to one rung.
inline constexpr double kShortestRung = 1.0 / 64.0;
inline constexpr int kProximalSteps = 200;
/// Corrections at the bound of rounding, while each lowers the residual to this share of it at least.
inline constexpr int kRefinements = 3;
inline constexpr double kRefinementHelps = 0.5;

}  // namespace palpate::integrate::tuning
