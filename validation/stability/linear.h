#pragma once
#include "linear_problem.h"
#include "row.h"

namespace palpate::stability {

inline constexpr int kLinearPeriods = 40;    ///< of H each
inline constexpr double kLinearRtol = 1e-6;  ///< of the columns under error control
/// Of elements: a hundred times looser, for their displacements are 1e-5 of positions that have a rounding.
inline double linear_rtol(const LinearProblem& problem) {
  return problem.is_by_elements() ? 100.0 * kLinearRtol : kLinearRtol;
}
inline constexpr double kAccurate = 0.05;   ///< error of a fixed step that counts as accurate
inline constexpr int kLastPeriod = 20000;   ///< a run whose formula overflows is followed to here
inline constexpr double kLinearUpTo = 1e2;  ///< elements that grow are followed to this energy

/// What a run is judged by, or what the formula of its method says of it beforehand.
struct LinearOutcome {
  double highest = 1.0;  ///< energy over that of the start
  double error = 0.0;    ///< largest; for fixed steps and statics over the second half
  bool overflows = false;
};

/// A fixed-step column's outcome by its formula alone (modal_steps.h).
LinearOutcome predict_linear(const Column& column, const LinearProblem& problem, double H);

/// Bars that separate the verdicts of an outcome; derivation in linear_theory.cpp.
struct LinearBars {
  double error;      ///< accurate up to here
  double kept;       ///< energy gain that counts as none
  double gain;       ///< largest energy gain that theory knows a reason for
  double agreement;  ///< with the formula of a fixed-step method, of the largest size of its course
};
Verdict verdict_of(const LinearOutcome& outcome, const LinearBars& bars);
LinearBars linear_bars(const Column& column, const LinearProblem& problem, double H, double highest,
                       long steps);

/// Theoretical expectation of a column on a linear problem with periods (and fixed steps) of `H`; derivation
/// in linear_theory.cpp.
Verdicts expect_linear(const CaseContext& context, const LinearProblem& problem, double H);

/// The time [s] that a column under error control must have reached, accurately, before it may say that it
/// has no steps left.
double least_progress(const Column& column, const LinearProblem& problem);

/// Runs the column over the problem and compares it with the exact motion, and with its own formula.
StabilityCell linear_cell(const CaseContext& context, const LinearProblem& problem, double H);

/// A case of a row: expect_linear() and linear_cell() of the problem that `make` builds.
SubCase linear_case(std::string name, std::function<LinearProblem()> make, double H);

}  // namespace palpate::stability
