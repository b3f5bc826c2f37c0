#include <cmath>

#include "linear.h"
#include "palpate/core/error.h"
#include "predicted_course.h"

// L- against A-stability. One oscillator with y = w H from 1e2 to 1e8, damping ratio 1/20, released at the
// amplitude 1/w, under every method at fixed steps. The exact motion has come to rest within a step (z y = 5
// and more). After kFew steps:
// - an L-stable method has |R(i y)| <= C/y, C below 20 for all in use: at most 20/y of the amplitude is left.
//   (BDF2 has a double root of size y^(-1/2) instead; with its L-stable first step this makes y^(-2).)
//     -> accurate
// - any other A-stable method keeps R(inf)^kFew of it, which its formula gives, and which does not depend on
//   y; generalised-alpha a multiple in the first step.
//     -> stable, bounded
//   The Newmark family stores the acceleration, with an error of eps y^2 of the moving part: above y = 1e7
//   this hides which of the two.
// - an explicit method is y/2 and more beyond its limit: overflow.
//     -> error
//
// The registry's L-stability is required: a method registered as L-stable that keeps the mode is wrong. For
// the others the formula decides (a multi-rate method's slow side alone may do more than the whole can
// guarantee). The agreement with the formula of linear_theory.cpp, 1, over 40 steps is also required.

namespace palpate::stability {
namespace {

constexpr double kH = 0.01, kDampingRatio = 0.05;
constexpr int kFew = 3;
constexpr double kRoundsAcceleration = 1e7;

LinearProblem mode(double y) { return {y / kH, kDampingRatio}; }

Verdict verdict_on(double amplitude, double y) {
  return amplitude <= 20.0 / y ? Verdict::kAccurate : amplitude <= 1.0 ? Verdict::kStable : Verdict::kBounded;
}

Verdicts expect(const CaseContext& context, double y) {
  if (is_explicit(context.column)) return {Verdict::kError};
  if (context.column.entry->traits.stability == dynamics::Stability::kL) return {Verdict::kAccurate};
  const LinearProblem problem = mode(y);
  PredictedCourse course(context.column, problem, kH);
  for (int i = 0; i < kFew; ++i) course.advance();
  if (context.column.entry->traits.family == "Newmark" && y >= kRoundsAcceleration)
    return {Verdict::kStable, Verdict::kBounded};
  return {verdict_on(std::sqrt(problem.energy(course.modes())), y)};
}

StabilityCell run(const CaseContext& context, double y) {
  const LinearProblem problem = mode(y);
  StabilityCell cell = linear_cell(context, problem, kH);
  if (cell.verdict > Verdict::kBounded) return cell;
  const auto few = problem.start();
  const auto stepper =
      make_stepper(context.column, few->system, few->state, spec_of(context.column, kLinearRtol, kH));
  for (int i = 1; i <= kFew; ++i)
    if (!stepper->advance_to(i * kH).ok()) {
      mark_wrong("forty steps succeeded, but fewer steps failed", cell);
      return cell;
    }
  const double left = problem.from_rest(*few);
  cell.verdict = verdict_on(left, y);
  cell.figure += fmt::format("; {:.1e} of the amplitude left after {} steps", left, kFew);
  return cell;
}

}  // namespace

Row stiff_modes_row() {
  Row row{"stiff-modes",
          "a stiff mode released, w H from 1e2 to 1e8, fixed steps: an L-stable method damps it at once, an "
          "A-stable one by R(inf) per step.  Detects methods that differ from their registry entry",
          RowColumns::kFixedSteppers};
  for (const int decade : {2, 3, 4, 6, 8}) {
    const double y = std::pow(10.0, decade);
    row.cases.push_back({fmt::format("w H = 1e{}", decade),
                         [y](const CaseContext& context) { return expect(context, y); },
                         [y](const CaseContext& context) { return run(context, y); }});
  }
  row.core = 2;
  return row;
}

}  // namespace palpate::stability
