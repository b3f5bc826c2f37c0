#include <cmath>
#include <optional>

#include "linear.h"
#include "palpate/core/error.h"
#include "predicted_course.h"

namespace palpate::stability {
namespace {

/// Energy over the initial energy from which a run may fail. ARKODE is the first to fail: where the
/// rounding of q, eps |q|, is above its tolerance rtol atol_q q_scale, thus at |q| = 5e7 times the initial
/// one, an energy of 2e15, or in the step before. The fast side of a multi-rate method passes through
/// intermediate values of a slow step, with a contact up to w H (w_C H)^2 times the final ones.
constexpr double kOverflowing = 1e10, kOverflowingOnItsWay = 1e3;
/// Energies up to this one are compared with the formula's.
constexpr double kComparable = 1e250;

struct Course {
  dynamics::StepResult result;
  LinearOutcome seen;
  double departure = 0.0;  ///< From the formula's course, relative to its size.
  double predicted = 1.0;  ///< Highest energy so far by the formula, including a failed step.
  bool finite = true, interrupted = false;
  bool left_linear = false;  ///< Elements: grown, as predicted, beyond their linear range.
};

Course follow(const CaseContext& context, const LinearProblem& problem, LinearProblem::Instance& run,
              dynamics::Stepper& stepper, double H) {
  const bool by_formula = has_modal_steps(context.column);
  // The stiff transients of a fixed step have decayed by then.
  const int settled = context.column.fixed || is_static(context.column) ? kLinearPeriods / 2 : 0;
  std::optional<PredictedCourse> formula;
  if (by_formula) formula.emplace(context.column, problem, H);
  const bool followed = by_formula && predict_linear(context.column, problem, H).overflows;
  Course course;
  for (int i = 1; i <= (followed ? kLastPeriod : kLinearPeriods); ++i) {
    if (context.time_is_up()) course.interrupted = true;
    if (course.interrupted) break;
    course.result = stepper.advance_to(i * H);
    if (formula) {
      formula->advance();
      course.predicted = formula->highest();
    }
    if (!course.result.ok()) break;
    course.finite = run.state.q().allFinite() && run.state.u().allFinite();
    if (!course.finite) break;
    course.seen.highest = std::max(course.seen.highest, problem.energy(run));
    if (problem.is_by_elements() && course.predicted > kLinearUpTo) {
      course.left_linear = true;
      if (course.seen.highest < 0.1 * kLinearUpTo) course.departure = 1.0;
      break;
    }
    if (formula) {
      if (course.predicted < kComparable)
        course.departure =
            std::max(course.departure, problem.distance(run, formula->modes()) / formula->size());
    }
    if (i > settled && i <= kLinearPeriods)
      course.seen.error = std::max(
          course.seen.error, is_static(context.column) ? problem.from_rest(run) : problem.error(run, i * H));
  }
  return course;
}

/// Checks the reason of an early end with an error: overflow for a fixed step, the limit of steps under error
/// control.
void judge_early_end(const CaseContext& context, const LinearProblem& problem, const Course& course,
                     const LinearProblem::Instance& last, double bar, StabilityCell& cell) {
  if (cell.verdict != Verdict::kError) return;
  std::string mistake;
  if (has_modal_steps(context.column)) {
    const bool fast_contact =
        context.column.entry->traits.family == "multi-rate" && problem.contact_share() > 0.0;
    if (!(course.predicted > (fast_contact ? kOverflowingOnItsWay : kOverflowing)))
      mistake = fmt::format("stopped where its formula has {:.1e} of the initial energy", course.predicted);
  } else if (!context.column.fixed) {
    const double least = least_progress(context.column, problem), t = last.state.time();
    const double error = problem.error(last, t);
    if (t < least)
      mistake = fmt::format("stopped at {:.1e} s, but its steps reach at least {:.1e} s", t, least);
    else if (!(error <= bar))
      mistake = fmt::format("stopped with an error of {:.1e} (limit {:.1e})", error, bar);
  }
  mark_wrong(mistake, cell);
}

}  // namespace

StabilityCell linear_cell(const CaseContext& context, const LinearProblem& problem, double H) {
  StabilityCell cell;
  const auto run = problem.start();
  IntegratorSpec spec = spec_of(context.column, linear_rtol(problem), H);
  if (problem.contact_share() > 0.0) spec.explicit_side = ExplicitSide::kContact;
  const auto stepper = make_stepper(context.column, run->system, run->state, spec);
  stepper->set_interrupt(context.expired);
  const Course course = follow(context, problem, *run, *stepper, H);
  cell.steps = stepper->counters().steps;
  const LinearBars bars = linear_bars(context.column, problem, H, course.seen.highest, cell.steps);
  cell.gain = course.seen.highest - 1.0;
  cell.error = course.seen.error;
  cell.figure = fmt::format("energy {:+.1e}, error {:.1e} (limit {:.1e})", cell.gain, cell.error, bars.error);
  if (has_modal_steps(context.column))
    cell.figure += fmt::format(", {:.0e} from its formula", course.departure);

  if (ended_early(context.column, course.result, course.finite, course.interrupted,
                  cell.gain > bars.gain && !has_modal_steps(context.column), cell)) {
    judge_early_end(context, problem, course, *run, bars.error, cell);
  } else {
    cell.verdict = course.left_linear ? Verdict::kBounded : verdict_of(course.seen, bars);
  }
  if (cell.verdict <= Verdict::kError && course.departure > bars.agreement) {
    cell.verdict = Verdict::kWrong;
    cell.reason =
        fmt::format("departs from its formula by {:.1e} (limit {:.1e})", course.departure, bars.agreement);
  }
  return cell;
}

SubCase linear_case(std::string name, std::function<LinearProblem()> make, double H) {
  return {std::move(name),
          [make, H](const CaseContext& context) { return expect_linear(context, make(), H); },
          [make, H](const CaseContext& context) { return linear_cell(context, make(), H); }};
}

}  // namespace palpate::stability
