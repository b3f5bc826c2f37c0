#pragma once
#include "linear_problem.h"
#include "row.h"

namespace palpate::stability {

inline constexpr int kLinearPeriods = 40;    ///< of H each
inline constexpr double kLinearRtol = 1e-6;  ///< of the columns under error control
inline constexpr double kAccurate = 0.05;    ///< error of a fixed step that counts as accurate

/// Theoretical expectation of a column on a linear problem with periods (and fixed steps) of `H`; derivation
/// in linear_theory.cpp.
Verdicts expect_linear(const Lab& lab, const LinearProblem& problem, double H);

/// Largest energy gain of a bounded method, by the theory in linear_theory.cpp.
double bounded_gain(const Column& column, const LinearProblem& problem, double H);

/// Amplification of one oscillator by a fixed-step method, found by running the method.
struct Amplification {
  double modulus = 0.0;      ///< of the largest eigenvalue of one step; infinite where it failed
  double evaluations = 0.0;  ///< of the force, a step
};
Amplification amplification(const Column& column, double omega, double damping_ratio, double H);

/// Runs the column over the problem and compares it with the exact motion.
StabilityCell linear_cell(const Lab& lab, const LinearProblem& problem, double H);

/// A case of a row: expect_linear() and linear_cell() of the problem that `make` builds.
SubCase linear_case(std::string name, std::function<LinearProblem()> make, double H);

}  // namespace palpate::stability
