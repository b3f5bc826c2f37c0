#pragma once
#include "linear_problem.h"
#include "row.h"

namespace palpate::stability {

inline constexpr int kLinearPeriods = 40;    ///< Number of periods H.
inline constexpr double kLinearRtol = 1e-6;  ///< For the columns under error control.
/// Returns the tolerance. For elements it is a hundred times looser: their displacements are 1e-5 of
/// positions with rounding errors.
inline double linear_rtol(const LinearProblem& problem) {
  return problem.is_by_elements() ? 100.0 * kLinearRtol : kLinearRtol;
}
inline constexpr double kAccurate = 0.05;   ///< Largest error of a fixed step that counts as accurate.
inline constexpr int kLastPeriod = 20000;   ///< A run whose formula overflows is followed up to this period.
inline constexpr double kLinearUpTo = 1e2;  ///< Growing elements are followed up to this energy.

/// Quantities that determine the verdict of a run, measured or predicted by the formula of its method.
struct LinearOutcome {
  double highest = 1.0;  ///< Energy over the initial energy.
  double error = 0.0;    ///< Largest; for fixed steps and statics over the second half.
  bool overflows = false;
};

/// Returns the outcome of a fixed-step column from its formula alone (modal_steps.h).
LinearOutcome predict_linear(const Column& column, const LinearProblem& problem, double H);

/// Limits that separate the verdicts of an outcome; derivation in linear_theory.cpp.
struct LinearBars {
  double error;      ///< Accurate up to this error.
  double kept;       ///< Energy gain that counts as none.
  double gain;       ///< Largest energy gain explained by theory.
  double agreement;  ///< With the formula of a fixed-step method, relative to the largest size of its course.
};
Verdict verdict_of(const LinearOutcome& outcome, const LinearBars& bars);
LinearBars linear_bars(const Column& column, const LinearProblem& problem, double H, double highest,
                       long steps);

/// Returns the theoretical expectation for a column on a linear problem with periods (and fixed steps) `H`;
/// derivation in linear_theory.cpp.
Verdicts expect_linear(const CaseContext& context, const LinearProblem& problem, double H);

/// Returns the time [s] that a column under error control must have reached, accurately, before it may end
/// for lack of steps.
double least_progress(const Column& column, const LinearProblem& problem);

/// Runs the column on the problem and compares it with the exact motion and with the formula of the method.
StabilityCell linear_cell(const CaseContext& context, const LinearProblem& problem, double H);

/// Returns a case of a row: expect_linear() and linear_cell() of the problem built by `make`.
SubCase linear_case(std::string name, std::function<LinearProblem()> make, double H);

}  // namespace palpate::stability
