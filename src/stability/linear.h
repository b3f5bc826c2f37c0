#pragma once
#include "linear_problem.h"
#include "row.h"

namespace palpate::stability {

inline constexpr int kLinearPeriods = 40;    ///< of H each
inline constexpr double kLinearRtol = 1e-6;  ///< of the columns under error control
inline constexpr double kAccurate = 0.05;    ///< error of a fixed step that counts as accurate

/// What theory says of a column on a linear problem with periods (and fixed steps) of `H`; derivation in
/// linear_theory.cpp.
Verdicts expect_linear(const Lab& lab, const LinearProblem& problem, double H);

/// Largest gain of energy of a method that is bounded, by the same theory.
double bounded_gain(const Column& column, const LinearProblem& problem, double H);

/// What a fixed-step method makes of one oscillator, found by running it.
struct Amplification {
  double modulus = 0.0;      ///< of the largest eigenvalue of one step; infinite where it failed
  double evaluations = 0.0;  ///< of the force, a step
};
Amplification amplification(const Column& column, double omega, double damping_ratio, double H);

/// Runs the column over the problem and holds it against the exact motion.
StabilityCell linear_cell(const Lab& lab, const LinearProblem& problem, double H);

/// Both as a case.
SubCase linear_case(std::string name, std::function<LinearProblem()> make, double H);

}  // namespace palpate::stability
